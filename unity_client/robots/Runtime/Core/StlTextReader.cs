// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway.Robots
{
    /// <summary>Reads an STL file of text.</summary>
    internal sealed class StlTextReader
    {
        private const int UsualBytes = 200; // of a triangle

        private readonly WordReader _words;
        private float[] _corners;
        private float[] _normals;
        private int _triangles;

        internal StlTextReader(byte[] text)
        {
            _words = new WordReader(text);
            int expected = Math.Min(text.Length / UsualBytes + 1, TriangleMesh.MaxTriangles);
            _corners = new float[9 * expected];
            _normals = new float[3 * expected];
        }

        /// <exception cref="MeshException">In words, with the line.</exception>
        internal TriangleMesh Read()
        {
            _words.Next();
            do
            {
                Expect("solid"); // some files have several
                _words.SkipLine();
                ReadSolid();
            }
            while (_words.Next());
            if (_triangles == 0)
            {
                throw new MeshException("the STL has no triangles");
            }
            Array.Resize(ref _corners, 9 * _triangles);
            Array.Resize(ref _normals, 3 * _triangles);
            return new TriangleMesh(_corners, _normals, null);
        }

        private void ReadSolid()
        {
            while (_words.Next() && _words.Is("facet"))
            {
                ReadFacet();
            }
            if (!_words.Is("endsolid"))
            {
                throw Unexpected("facet or endsolid");
            }
            _words.SkipLine(); // the name again
        }

        private void ReadFacet()
        {
            if (_triangles == TriangleMesh.MaxTriangles)
            {
                throw new MeshException("the STL has more than " + TriangleMesh.MaxTriangles + " triangles");
            }
            if (3 * _triangles == _normals.Length)
            {
                Array.Resize(ref _corners, 2 * _corners.Length);
                Array.Resize(ref _normals, 2 * _normals.Length);
            }
            NextIs("normal");
            for (int i = 0; i < 3; i++)
            {
                _normals[3 * _triangles + i] = Number(true);
            }
            NextIs("outer");
            NextIs("loop");
            for (int corner = 0; corner < 3; corner++)
            {
                NextIs("vertex");
                for (int i = 0; i < 3; i++)
                {
                    _corners[9 * _triangles + 3 * corner + i] = Number(false);
                }
            }
            NextIs("endloop");
            NextIs("endfacet");
            _triangles++;
        }

        private void NextIs(string word)
        {
            _words.Next();
            Expect(word);
        }

        private void Expect(string word)
        {
            if (!_words.Is(word))
            {
                throw Unexpected(word);
            }
        }

        /// <summary>The next word as a number.</summary>
        /// <param name="isNormal">Whether anything else is NaN: programs write nan, -nan(ind) and the like there.</param>
        private float Number(bool isNormal)
        {
            if (_words.Next() && _words.TryFloat(out float value))
            {
                return value;
            }
            if (!isNormal || _words.IsOver)
            {
                throw Unexpected("a finite number");
            }
            return float.NaN;
        }

        private MeshException Unexpected(string expected) => new MeshException(
            "line " + _words.Line + " of the STL: expected " + expected + ", got " + _words.Shown);
    }
}
