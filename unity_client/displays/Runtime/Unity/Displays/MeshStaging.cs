// SPDX-License-Identifier: Apache-2.0
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>Arrays that are filled, uploaded to a mesh and used again, for one mesh or for one after the other.</summary>
    internal sealed class MeshStaging
    {
        internal Vector3[] Positions = new Vector3[0];
        internal Color32[] Colors = new Color32[0];
        internal int[] Indices = new int[0];

        /// <summary>Makes room. The former content is lost.</summary>
        internal void Reserve(int points, int indices)
        {
            if (Positions.Length < points)
            {
                Positions = new Vector3[points];
                Colors = new Color32[points];
            }
            if (Indices.Length < indices)
            {
                Indices = new int[indices];
            }
        }
    }
}
