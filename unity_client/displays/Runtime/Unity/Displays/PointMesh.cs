// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Shapes;
using UnityEngine;
using UnityEngine.Rendering;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// Coloured points, lines or triangles as a mesh. Made when a display is enabled: it does not survive a reload of
    /// scripts in Play, after which Unity calls no Awake.
    /// </summary>
    internal sealed class PointMesh
    {
        // in the order of MeshKind
        private static readonly MeshTopology[] Topologies =
        {
            MeshTopology.Triangles, MeshTopology.Lines, MeshTopology.Points,
        };

        private readonly Mesh _mesh = new();
        private readonly MeshFilter _filter;
        private readonly MeshRenderer _renderer;
        private readonly Material _material; // ours, if the renderer had none
        private readonly MeshStaging _staging;

        /// <param name="display">Has a MeshFilter and a MeshRenderer next to it.</param>
        /// <param name="isSolid">Whether triangles are drawn, which hide each other.</param>
        /// <param name="staging">That several meshes share. Null for a separate one.</param>
        internal PointMesh(Component display, bool isSolid = false, MeshStaging staging = null)
        {
            _staging = staging ?? new MeshStaging();
            _mesh.name = display.name;
            _mesh.MarkDynamic();
            _filter = display.GetComponent<MeshFilter>();
            _filter.sharedMesh = _mesh;
            _renderer = display.GetComponent<MeshRenderer>();
            if (_renderer.sharedMaterial == null)
            {
                _material = isSolid ? DisplayMaterials.Solid() : DisplayMaterials.Flat();
                _renderer.sharedMaterial = _material;
            }
            _renderer.shadowCastingMode = ShadowCastingMode.Off;
            _renderer.receiveShadows = false;
        }

        internal Vector3[] Positions => _staging.Positions;

        internal Color32[] Colors => _staging.Colors;

        internal int[] Indices => _staging.Indices;

        /// <summary>Makes room. The former content is lost.</summary>
        internal void Reserve(int points, int indices) => _staging.Reserve(points, indices);

        internal void Upload(int points, int indices, MeshTopology topology)
        {
            _mesh.Clear(); // first, or the old indices would refer to points that are gone
            _mesh.indexFormat = IndexFormat.UInt32; // 16 bits end at 65,535 points
            _mesh.SetVertices(Positions, 0, points);
            _mesh.SetColors(Colors, 0, points);
            _mesh.SetIndices(Indices, 0, indices, topology, 0);
        }

        internal void Upload(MeshBuffer shapes)
        {
            Reserve(shapes.VertexCount, shapes.IndexCount);
            Vector3[] positions = Positions;
            Color32[] colors = Colors;
            for (int i = 0; i < shapes.VertexCount; i++)
            {
                Rgba color = shapes.Colors[i];
                positions[i] = new Vector3(
                    shapes.Positions[3 * i], shapes.Positions[3 * i + 1], shapes.Positions[3 * i + 2]);
                colors[i] = new Color32(color.r, color.g, color.b, color.a);
            }
            System.Array.Copy(shapes.Indices, Indices, shapes.IndexCount);
            Upload(shapes.VertexCount, shapes.IndexCount, Topologies[(int)shapes.Kind]);
        }

        internal void Clear() => _mesh.Clear();

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
