// SPDX-License-Identifier: Apache-2.0
using UnityEngine;
using UnityEngine.Rendering;

namespace Ros2Gateway.Unity
{
    /// <summary>Coloured points as a mesh; its arrays are filled, uploaded and used again.</summary>
    internal sealed class PointMesh
    {
        private readonly Mesh _mesh = new Mesh();
        private readonly MeshFilter _filter;
        private readonly MeshRenderer _renderer;
        private readonly Material _material; // ours, if the renderer had none

        internal Vector3[] Positions = new Vector3[0];
        internal Color32[] Colors = new Color32[0];
        internal int[] Indices = new int[0];

        /// <param name="display">Has a MeshFilter and a MeshRenderer beside it.</param>
        internal PointMesh(Component display)
        {
            _mesh.name = display.name;
            _mesh.MarkDynamic();
            _filter = display.GetComponent<MeshFilter>();
            _filter.sharedMesh = _mesh;
            _renderer = display.GetComponent<MeshRenderer>();
            if (_renderer.sharedMaterial == null)
            {
                // the one shader that is part of every build and takes the colours of vertices
                Shader shader = Shader.Find("Sprites/Default");
                _material = shader != null ? new Material(shader) : null;
                _renderer.sharedMaterial = _material;
            }
            _renderer.shadowCastingMode = ShadowCastingMode.Off;
            _renderer.receiveShadows = false;
        }

        /// <summary>Makes room; what was there is lost.</summary>
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

        internal void Upload(int points, int indices, MeshTopology topology)
        {
            _mesh.Clear(); // first, or the old indices would refer to points that are gone
            _mesh.indexFormat = IndexFormat.UInt32; // 16 bits end at 65,535 points
            _mesh.SetVertices(Positions, 0, points);
            _mesh.SetColors(Colors, 0, points);
            _mesh.SetIndices(Indices, 0, indices, topology, 0);
        }

        internal void Clear()
        {
            _mesh.Clear();
        }

        internal void Destroy()
        {
            if (_filter != null && _filter.sharedMesh == _mesh)
            {
                _filter.sharedMesh = null;
            }
            if (_material != null && _renderer != null && _renderer.sharedMaterial == _material)
            {
                _renderer.sharedMaterial = null;
            }
            Object.Destroy(_mesh);
            Object.Destroy(_material);
        }
    }
}
