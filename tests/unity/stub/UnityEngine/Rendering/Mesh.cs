// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;
using UnityEngine.Stage;

namespace UnityEngine
{
    /// <summary>Complains as Unity does where vertices, colours and indices do not fit together.</summary>
    public sealed class Mesh : Object
    {
        private Vector3[] _vertices = new Vector3[0];
        private Color32[] _colors = new Color32[0];
        private int[] _indices = new int[0];
        private int _vertexCount;
        private int _colorCount;
        private int _indexCount;
        private MeshTopology _topology;

        public Rendering.IndexFormat indexFormat { get; set; }

        public int vertexCount
        {
            get { return _vertexCount; }
        }

        public Bounds bounds { get; set; }

        public Vector3[] vertices
        {
            get { return First(_vertices, _vertexCount); }
            set { SetVertices(value, 0, value.Length); }
        }

        public int[] triangles
        {
            get { return First(_indices, _indexCount); }
            set { SetIndices(value, MeshTopology.Triangles, 0); }
        }

        public Vector2[] uv { get; set; }

        public Vector3[] normals { get; set; }

        public Color32[] colors32
        {
            get { return First(_colors, _colorCount); }
            set { SetColors(value, 0, value.Length); }
        }

        public void Clear()
        {
            MainThread.Check("ClearImpl");
            _vertexCount = _colorCount = _indexCount = 0;
        }

        public void MarkDynamic()
        {
        }

        public void SetVertices(List<Vector3> inVertices)
        {
            SetVertices(inVertices.ToArray(), 0, inVertices.Count);
        }

        public void SetVertices(Vector3[] inVertices, int start, int length)
        {
            MainThread.Check("SetArrayForChannelImpl");
            for (int i = 0; i < _indexCount; i++)
            {
                if (_indices[i] >= length)
                {
                    Debug.LogError("Mesh.vertices is too small. The supplied vertex array has less vertices "
                        + "than are referenced by the triangles array.");
                    return;
                }
            }
            Take(ref _vertices, ref _vertexCount, inVertices, start, length);
            _colorCount = _colorCount == length ? length : 0;
        }

        public void SetColors(List<Color32> inColors)
        {
            SetColors(inColors.ToArray(), 0, inColors.Count);
        }

        public void SetColors(Color32[] inColors, int start, int length)
        {
            MainThread.Check("SetArrayForChannelImpl");
            if (length != _vertexCount)
            {
                Debug.LogError("Mesh.colors is out of bounds. The supplied array needs to be the same size "
                    + "as the Mesh.vertices array.");
                return;
            }
            Take(ref _colors, ref _colorCount, inColors, start, length);
        }

        public void SetIndices(int[] indices, MeshTopology topology, int submesh)
        {
            SetIndices(indices, 0, indices.Length, topology, submesh);
        }

        public void SetIndices(int[] indices, int indicesStart, int indicesLength, MeshTopology topology,
            int submesh, bool calculateBounds = true, int baseVertex = 0)
        {
            MainThread.Check("SetIndicesImpl");
            for (int i = indicesStart; i < indicesStart + indicesLength; i++)
            {
                if (indices[i] < 0 || indices[i] >= _vertexCount)
                {
                    Debug.LogError("Failed setting indices. Some indices are referencing out of bounds "
                        + "vertices.");
                    return;
                }
            }
            Take(ref _indices, ref _indexCount, indices, indicesStart, indicesLength);
            _topology = topology;
            if (calculateBounds)
            {
                RecalculateBounds();
            }
        }

        public int[] GetIndices(int submesh)
        {
            return First(_indices, _indexCount);
        }

        public MeshTopology GetTopology(int submesh)
        {
            return _topology;
        }

        public void RecalculateBounds()
        {
            if (_vertexCount == 0)
            {
                return;
            }
            Vector3 low = _vertices[0];
            Vector3 high = low;
            for (int i = 1; i < _vertexCount; i++)
            {
                Vector3 v = _vertices[i];
                low = new Vector3(Mathf.Min(low.x, v.x), Mathf.Min(low.y, v.y), Mathf.Min(low.z, v.z));
                high = new Vector3(Mathf.Max(high.x, v.x), Mathf.Max(high.y, v.y), Mathf.Max(high.z, v.z));
            }
            bounds = new Bounds((low + high) / 2F, high - low);
        }

        public void RecalculateNormals()
        {
        }

        // grows only, as on the GPU's side: a test can measure what a component allocates
        private static void Take<T>(ref T[] to, ref int count, T[] from, int start, int length)
        {
            if (to.Length < length)
            {
                to = new T[length];
            }
            System.Array.Copy(from, start, to, 0, length);
            count = length;
        }

        private static T[] First<T>(T[] values, int count)
        {
            var first = new T[count];
            System.Array.Copy(values, first, count);
            return first;
        }
    }

    public sealed class MeshFilter : Component
    {
        private Mesh _mesh;

        public Mesh mesh
        {
            get { return _mesh ?? (_mesh = new Mesh()); }
            set { _mesh = value; }
        }

        public Mesh sharedMesh
        {
            get { return _mesh; }
            set { _mesh = value; }
        }
    }

    public enum MeshTopology
    {
        Triangles = 0,
        Quads = 2,
        Lines = 3,
        LineStrip = 4,
        Points = 5,
    }
}

namespace UnityEngine.Rendering
{
    public enum IndexFormat
    {
        UInt16 = 0,
        UInt32 = 1,
    }

    public enum ShadowCastingMode
    {
        Off = 0,
        On = 1,
        TwoSided = 2,
        ShadowsOnly = 3,
    }
}
