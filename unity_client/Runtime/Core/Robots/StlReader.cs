// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway.Robots
{
    /// <summary>
    /// Reads STL files, binary and ASCII (Burns, Automated Fabrication, 1993, section 6.5). Any thread.
    /// </summary>
    /// <remarks>
    /// A normal that is missing, as many programs write it (0, 0, 0 or NaN), is that of the corners. Colours, which some
    /// programs hide in binary files, are not read.
    /// </remarks>
    public static class StlReader
    {
        /// <summary>More are refused: as arrays 48 MB. A robot's link has some 10,000.</summary>
        public const int MaxTriangles = 1000000;

        private const int HeaderBytes = 84; // 80 of any text, then how many triangles there are
        private const int TriangleBytes = 50; // a normal and three corners of float32, and two bytes for anything
        private const int NormalBytes = 12;
        private const int CornersBytes = 36;

        /// <summary>Reads a file.</summary>
        /// <exception cref="StlException">It is none, in words.</exception>
        public static StlMesh Read(byte[] stl)
        {
            if (stl == null || stl.Length == 0)
            {
                throw new StlException("the STL is empty");
            }
            return IsText(stl) ? new StlTextReader(stl).Read() : ReadBinary(stl);
        }

        /// <summary>Replaces normals that are missing by those of the corners, and makes all of length 1.</summary>
        internal static void MakeNormals(float[] corners, float[] normals, int triangles)
        {
            for (int i = 0; i < triangles; i++)
            {
                int at = 3 * i;
                double x = normals[at], y = normals[at + 1], z = normals[at + 2];
                double length = Math.Sqrt(x * x + y * y + z * z);
                if (!(length > 0 && length <= float.MaxValue)) // false for NaN, too
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

        /// <summary>
        /// Whether it begins with the word solid and can be no binary file: many programs begin those with it, too.
        /// </summary>
        private static bool IsText(byte[] stl)
        {
            const string Word = "solid";
            int at = 0;
            while (at < stl.Length && stl[at] <= ' ')
            {
                at++;
            }
            for (int i = 0; i < Word.Length; i++)
            {
                if (at + i >= stl.Length || (stl[at + i] | 0x20) != Word[i])
                {
                    return false;
                }
            }
            // A text has no byte 0. A binary file has one as the last of its count, if no earlier one.
            return Array.IndexOf(stl, (byte)0, 0, Math.Min(stl.Length, HeaderBytes)) < 0;
        }

        private static StlMesh ReadBinary(byte[] stl)
        {
            if (stl.Length < HeaderBytes)
            {
                throw new StlException("the STL has " + stl.Length + " bytes, a binary one has at least " + HeaderBytes);
            }
            long count = BitConverter.ToUInt32(stl, HeaderBytes - 4); // little-endian, as all that Unity runs on
            long bytes = HeaderBytes + TriangleBytes * count;
            // Some programs append a line; what is as long as a triangle should have been counted.
            if (bytes > stl.Length || stl.Length - bytes >= TriangleBytes)
            {
                throw new StlException(
                    "the STL has " + stl.Length + " bytes, its " + count + " triangles take " + bytes
                    + ": it is incomplete, or no STL");
            }
            if (count == 0 || count > MaxTriangles)
            {
                throw new StlException("the STL has " + count + " triangles, must have 1 to " + MaxTriangles);
            }
            int triangles = (int)count;
            float[] normals = new float[3 * triangles];
            float[] corners = new float[9 * triangles];
            for (int i = 0; i < triangles; i++)
            {
                int at = HeaderBytes + TriangleBytes * i;
                Buffer.BlockCopy(stl, at, normals, NormalBytes * i, NormalBytes);
                Buffer.BlockCopy(stl, at + NormalBytes, corners, CornersBytes * i, CornersBytes);
            }
            for (int i = 0; i < corners.Length; i++)
            {
                if (!(Math.Abs(corners[i]) <= float.MaxValue)) // false for NaN, too
                {
                    throw new StlException("triangle " + i / 9 + " of the STL, counted from 0, has a coordinate that is "
                        + (float.IsNaN(corners[i]) ? "NaN" : "infinite"));
                }
            }
            MakeNormals(corners, normals, triangles);
            return new StlMesh(corners, normals);
        }
    }
}
