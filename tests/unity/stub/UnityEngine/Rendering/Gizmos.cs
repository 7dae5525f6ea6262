// SPDX-License-Identifier: Apache-2.0
namespace UnityEngine
{
    /// <summary>Draws nothing: nobody looks.</summary>
    public sealed class Gizmos
    {
        public static Color color { get; set; }

        public static void DrawWireSphere(Vector3 center, float radius)
        {
        }
    }
}
