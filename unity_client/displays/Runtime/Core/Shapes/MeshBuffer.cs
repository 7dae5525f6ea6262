// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway.Shapes
{
    /// <summary>The meaning of the indices of a <see cref="MeshBuffer"/>: three, two or one make a part.</summary>
    public enum MeshKind
    {
        /// <summary>Three are a triangle. Clockwise, seen from its front.</summary>
        Triangles,

        /// <summary>Two are a line.</summary>
        Lines,

        /// <summary>Each is a point.</summary>
        Points,
    }

    /// <summary>
    /// Vertices and indices as a graphics card takes them, in Unity's axes (<see cref="Ruf"/>). It is filled, read,
    /// cleared and filled again.
    /// </summary>
    public sealed class MeshBuffer
    {
        /// <summary>More vertices are left out: with their indices about 40 MB.</summary>
        public const int MaxVertices = 1 << 20;

        private const int FirstLength = 64; // a box has 24 vertices and 36 indices

        private float[] _positions = new float[3 * FirstLength];
        private Rgba[] _colors = new Rgba[FirstLength];
        private int[] _indices = new int[2 * FirstLength];
        private int _room = MaxVertices;

        /// <summary>How many vertices fit, for who wants fewer than <see cref="MaxVertices"/>.</summary>
        public int Room
        {
            get => _room;
            set => _room = Math.Max(0, Math.Min(value, MaxVertices));
        }

        /// <summary>The meaning of the indices.</summary>
        public MeshKind Kind { get; private set; }

        /// <summary>How many vertices there are.</summary>
        public int VertexCount { get; private set; }

        /// <summary>How many indices there are.</summary>
        public int IndexCount { get; private set; }

        /// <summary>Whether something was left out because there was too much.</summary>
        public bool IsTruncated { get; private set; }

        /// <summary>x, y, z of each vertex. Longer than needed.</summary>
        public float[] Positions => _positions;

        /// <summary>The colour of each vertex. Longer than needed.</summary>
        public Rgba[] Colors => _colors;

        /// <summary>The indices. Longer than needed.</summary>
        public int[] Indices => _indices;

        /// <summary>Empties it.</summary>
        public void Clear(MeshKind kind)
        {
            Kind = kind;
            VertexCount = 0;
            IndexCount = 0;
            IsTruncated = false;
        }

        /// <summary>Whether so many more vertices fit. If not, notes that something was left out.</summary>
        public bool HasRoom(int vertices)
        {
            bool hasRoom = VertexCount + vertices <= _room;
            IsTruncated |= !hasRoom;
            return hasRoom;
        }

        /// <summary>Adds a vertex, in ROS' axes, and returns its index.</summary>
        public int Add(Vector3<Flu> point, Rgba color)
        {
            if (VertexCount == _colors.Length)
            {
                Array.Resize(ref _positions, 2 * _positions.Length);
                Array.Resize(ref _colors, 2 * _colors.Length);
            }
            Vector3<Ruf> unity = point.To<Ruf>();
            int at = 3 * VertexCount;
            _positions[at] = (float)unity.x;
            _positions[at + 1] = (float)unity.y;
            _positions[at + 2] = (float)unity.z;
            _colors[VertexCount] = color;
            return VertexCount++;
        }

        /// <summary>Adds a triangle, its corners counterclockwise seen from its front, as in ROS.</summary>
        public void Triangle(int a, int b, int c)
        {
            Index(a);
            Index(c); // Unity's front is where they are clockwise
            Index(b);
        }

        /// <summary>Adds a line.</summary>
        public void Line(int a, int b)
        {
            Index(a);
            Index(b);
        }

        /// <summary>Adds a point.</summary>
        public void Point(int a) => Index(a);

        private void Index(int value)
        {
            if (IndexCount == _indices.Length)
            {
                Array.Resize(ref _indices, 2 * _indices.Length);
            }
            _indices[IndexCount++] = value;
        }
    }
}
