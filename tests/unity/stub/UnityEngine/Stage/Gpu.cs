// SPDX-License-Identifier: Apache-2.0
namespace UnityEngine.Stage
{
    /// <summary>The abilities of the graphics card.</summary>
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
