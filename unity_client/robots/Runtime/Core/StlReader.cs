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
        private const int HeaderBytes = 84; // 80 of any text, then how many triangles there are
        private const int TriangleBytes = 50; // a normal and three corners of float32, and two bytes for anything
        private const int NormalBytes = 12;
        private const int CornersBytes = 36;

        /// <summary>Reads a file.</summary>
        /// <exception cref="MeshException">It is invalid, in words.</exception>
        public static TriangleMesh Read(byte[] stl)
        {
            if (stl == null || stl.Length == 0)
            {
                throw new MeshException("the STL is empty");
            }
            return IsText(stl) ? new StlTextReader(stl).Read() : ReadBinary(stl);
        }

        /// <summary>
        /// Whether it begins with the word solid and can be no binary file: many programs begin those with it as well.
        /// </summary>
        private static bool IsText(byte[] stl)
        {
            const string Word = "solid";
            int at = WordReader.Start(stl);
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

        private static TriangleMesh ReadBinary(byte[] stl)
        {
            if (stl.Length < HeaderBytes)
            {
                throw new MeshException("the STL has " + stl.Length + " bytes, a binary one has at least " + HeaderBytes);
            }
            long count = BitConverter.ToUInt32(stl, HeaderBytes - 4); // little-endian, as all that Unity runs on
            long bytes = HeaderBytes + TriangleBytes * count;
            // Some programs append a line. More bytes than a triangle's should have been counted.
            if (bytes > stl.Length || stl.Length - bytes >= TriangleBytes)
            {
                throw new MeshException(
                    "the STL has " + stl.Length + " bytes, its " + count + " triangles take " + bytes
                    + ": it is incomplete, or not an STL");
            }
            if (count == 0 || count > TriangleMesh.MaxTriangles)
            {
                throw new MeshException("the STL has " + count + " triangles, must have 1 to " + TriangleMesh.MaxTriangles);
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
                if (!(Math.Abs(corners[i]) <= float.MaxValue)) // false for NaN as well
                {
                    throw new MeshException("triangle " + i / 9 + " of the STL, counted from 0, has a coordinate that is "
                        + (float.IsNaN(corners[i]) ? "NaN" : "infinite"));
                }
            }
            return new TriangleMesh(corners, normals, null);
        }
    }
}
