// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway.Robots
{
    /// <summary>Reads the files that robots' descriptions name, by what their names end in. Any thread.</summary>
    public static class MeshReader
    {
        /// <summary>Whether files with such a name are read.</summary>
        public static bool CanRead(string name) => IsStl(name) || IsCollada(name);

        /// <summary>Reads a file.</summary>
        /// <param name="name">Its name or address, of which the end counts: .stl or .dae.</param>
        /// <exception cref="MeshException">It is not such a file, in words.</exception>
        public static TriangleMesh Read(string name, byte[] file)
        {
            if (IsStl(name))
            {
                return StlReader.Read(file);
            }
            if (IsCollada(name))
            {
                return ColladaReader.Read(file);
            }
            throw new MeshException("expected a file that ends in .stl or .dae, got " + name);
        }

        private static bool IsStl(string name) => name.EndsWith(".stl", StringComparison.OrdinalIgnoreCase);

        private static bool IsCollada(string name) => name.EndsWith(".dae", StringComparison.OrdinalIgnoreCase);
    }
}
