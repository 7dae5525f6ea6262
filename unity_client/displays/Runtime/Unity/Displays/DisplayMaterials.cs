// SPDX-License-Identifier: Apache-2.0
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>Materials for displays whose renderer has none.</summary>
    internal static class DisplayMaterials
    {
        private const string SolidShader = "Ros2GatewaySolid"; // in this package's Resources

        /// <summary>Of points, lines and pictures: takes the colours of vertices, and a texture.</summary>
        internal static Material Flat()
        {
            // the one shader that is part of every build
            Shader shader = Shader.Find("Sprites/Default");
            return shader != null ? new Material(shader) : null;
        }

        /// <summary>Of solids: takes the colours of vertices, and what is in front hides what is behind.</summary>
        internal static Material Solid()
        {
            Shader shader = Resources.Load<Shader>(SolidShader);
            return shader != null ? new Material(shader) : Flat();
        }
    }
}
