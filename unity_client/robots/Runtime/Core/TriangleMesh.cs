// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Shapes;

namespace Ros2Gateway.Robots
{
    /// <summary>A file that is not a mesh, or one that cannot be drawn. The text says what is wrong, and where.</summary>
    public sealed class MeshException : Exception
    {
        internal MeshException(string errorText)
            : base(errorText)
        {
        }
    }

    /// <summary>Triangles as <see cref="MeshReader"/> reads them: of a robot's link, in its axes, in metres.</summary>
    public sealed class TriangleMesh
    {
        /// <summary>Files with more are refused: as arrays 48 MB. A robot's link has about 10,000.</summary>
        public const int MaxTriangles = 1000000;

        /// <param name="corners">Finite.</param>
        /// <param name="normals">Of any length. Those that are missing, 0 or NaN, are made from the corners.</param>
        /// <param name="colors">Null if the file has none.</param>
        internal TriangleMesh(float[] corners, float[] normals, Rgba?[] colors)
        {
            Corners = corners;
            Normals = normals;
            Colors = colors;
            MakeNormals(corners, normals);
        }

        /// <summary>How many triangles there are.</summary>
        public int TriangleCount => Normals.Length / 3;

        /// <summary>x, y, z of three corners for each, counterclockwise seen from its front. All are finite.</summary>
        public float[] Corners { get; private set; }

        /// <summary>x, y, z for each, of length 1. 0, 0, 0 for a triangle that is a line or a point.</summary>
        public float[] Normals { get; private set; }

        /// <summary>The colour of each, null for one without. Null if no triangle has one.</summary>
        public Rgba?[] Colors { get; private set; }

        /// <summary>Adds triangles to a buffer until it has no room: scaled, then placed, and lit from above.</summary>
        /// <param name="first">The first triangle to add.</param>
        /// <param name="scale">Factors along x, y and z. A negative one mirrors.</param>
        /// <param name="color">Of triangles without a colour.</param>
        /// <returns>The first triangle that is left. <see cref="TriangleCount"/> if none is.</returns>
        /// <exception cref="MeshException">A corner is farther away than float32 goes.</exception>
        public int AddTo(MeshBuffer buffer, int first, Pose<Flu> origin, Vector3<Flu> scale, Rgba color)
        {
            bool isMirrored = (scale.x < 0) ^ (scale.y < 0) ^ (scale.z < 0);
            // a normal is scaled by the inverse factors: except for its length, by the product of the other two
            double side = isMirrored ? -1 : 1;
            Vector3<Flu> normalScale = new(
                side * scale.y * scale.z, side * scale.x * scale.z, side * scale.x * scale.y);
            int triangle = first;
            for (; triangle < TriangleCount && buffer.HasRoom(3); triangle++)
            {
                Vector3<Flu> normal = origin.orientation * Scaled(Normals, 3 * triangle, normalScale);
                Rgba own = Colors == null ? color : Colors[triangle] ?? color;
                Rgba lit = own.Lit((1 / normal.Length) * normal);
                int at = 9 * triangle;
                int a = buffer.Add(Placed(origin, Scaled(Corners, at, scale)), lit);
                int b = buffer.Add(Placed(origin, Scaled(Corners, at + 3, scale)), lit);
                int c = buffer.Add(Placed(origin, Scaled(Corners, at + 6, scale)), lit);
                if (isMirrored)
                {
                    buffer.Triangle(a, c, b); // a mirror turns the triangle's front to the back
                }
                else
                {
                    buffer.Triangle(a, b, c);
                }
            }
            return triangle;
        }

        private static Vector3<Flu> Scaled(float[] values, int at, Vector3<Flu> scale) =>
            new Vector3<Flu>(scale.x * values[at], scale.y * values[at + 1], scale.z * values[at + 2]);

        private static Vector3<Flu> Placed(Pose<Flu> origin, Vector3<Flu> corner)
        {
            Vector3<Flu> placed = origin * corner;
            if (!(Math.Abs(placed.x) + Math.Abs(placed.y) + Math.Abs(placed.z) <= float.MaxValue))
            {
                throw new MeshException("with its scale, a corner is at " + placed + ", farther away than float32 goes");
            }
            return placed;
        }

        private static void MakeNormals(float[] corners, float[] normals)
        {
            for (int i = 0; i < normals.Length / 3; i++)
            {
                int at = 3 * i;
                double x = normals[at], y = normals[at + 1], z = normals[at + 2];
                double length = Math.Sqrt(x * x + y * y + z * z);
                if (!(length > 0 && length <= float.MaxValue)) // false for NaN as well
                {
                    int a = 9 * i;
                    double ux = (double)corners[a + 3] - corners[a];
                    double uy = (double)corners[a + 4] - corners[a + 1];
                    double uz = (double)corners[a + 5] - corners[a + 2];
                    double vx = (double)corners[a + 6] - corners[a];
                    double vy = (double)corners[a + 7] - corners[a + 1];
                    double vz = (double)corners[a + 8] - corners[a + 2];
                    x = uy * vz - uz * vy;
                    y = uz * vx - ux * vz;
                    z = ux * vy - uy * vx;
                    length = Math.Sqrt(x * x + y * y + z * z);
                }
                double factor = length > 0 ? 1 / length : 0;
                normals[at] = (float)(factor * x);
                normals[at + 1] = (float)(factor * y);
                normals[at + 2] = (float)(factor * z);
            }
        }
    }
}
