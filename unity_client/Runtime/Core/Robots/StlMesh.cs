// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Shapes;

namespace Ros2Gateway.Robots
{
    /// <summary>Bytes that are no STL, or one that cannot be drawn; the text says what is wrong, and where.</summary>
    public sealed class StlException : Exception
    {
        internal StlException(string errorText)
            : base(errorText)
        {
        }
    }

    /// <summary>Triangles as <see cref="StlReader"/> reads them, in the file's own axes and unit.</summary>
    public sealed class StlMesh
    {
        internal StlMesh(float[] corners, float[] normals)
        {
            Corners = corners;
            Normals = normals;
        }

        /// <summary>How many triangles there are.</summary>
        public int TriangleCount
        {
            get { return Normals.Length / 3; }
        }

        /// <summary>x, y, z of three corners for each, counterclockwise seen from its front. All are finite.</summary>
        public float[] Corners { get; private set; }

        /// <summary>x, y, z for each, of length 1; 0, 0, 0 for a triangle that is a line or a point.</summary>
        public float[] Normals { get; private set; }

        /// <summary>Adds triangles to a buffer until it has no room: scaled, then placed, and lit from above.</summary>
        /// <param name="first">The first triangle to add.</param>
        /// <param name="scale">Factors along x, y and z; a negative one mirrors.</param>
        /// <returns>The first triangle that is left; <see cref="TriangleCount"/> if none is.</returns>
        /// <exception cref="StlException">A corner is farther away than float32 goes.</exception>
        public int AddTo(MeshBuffer buffer, int first, Pose<Flu> origin, Vector3<Flu> scale, Rgba color)
        {
            bool isMirrored = (scale.x < 0) ^ (scale.y < 0) ^ (scale.z < 0);
            // a normal is scaled by the inverse factors: but for its length, by the product of the other two
            double side = isMirrored ? -1 : 1;
            Vector3<Flu> normalScale = new Vector3<Flu>(
                side * scale.y * scale.z, side * scale.x * scale.z, side * scale.x * scale.y);
            int triangle = first;
            for (; triangle < TriangleCount && buffer.HasRoom(3); triangle++)
            {
                Vector3<Flu> normal = origin.orientation * Scaled(Normals, 3 * triangle, normalScale);
                Rgba lit = color.Lit((1 / normal.Length) * normal);
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

        private static Vector3<Flu> Scaled(float[] values, int at, Vector3<Flu> scale)
        {
            return new Vector3<Flu>(scale.x * values[at], scale.y * values[at + 1], scale.z * values[at + 2]);
        }

        private static Vector3<Flu> Placed(Pose<Flu> origin, Vector3<Flu> corner)
        {
            Vector3<Flu> placed = origin * corner;
            if (!(Math.Abs(placed.x) + Math.Abs(placed.y) + Math.Abs(placed.z) <= float.MaxValue))
            {
                throw new StlException("with its scale, a corner is at " + placed + ", farther away than float32 goes");
            }
            return placed;
        }
    }
}
