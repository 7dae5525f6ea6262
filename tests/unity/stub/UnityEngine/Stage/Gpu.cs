// SPDX-License-Identifier: Apache-2.0
namespace UnityEngine.Stage
{
    /// <summary>What the graphics card can do.</summary>
    public static class Gpu
    {
        /// <summary>Whether it can be read without waiting for it.</summary>
        public static bool ReadsBack = true;

        /// <summary>Whether reading it fails.</summary>
        public static bool Fails;

        /// <summary>How often Camera.Render was called.</summary>
        public static int Rendered;
    }
}
