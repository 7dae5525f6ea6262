// SPDX-License-Identifier: Apache-2.0
using System;
using System.Text;
using Ros2Gateway.Json;

namespace Ros2Gateway.Robots
{
    /// <summary>Reads an STL file of text, from bytes without a string of each word.</summary>
    internal sealed class StlTextReader
    {
        private const int UsualBytes = 200; // of a triangle
        private const int MaxDigits = 18; // so many fit into 64 bits; float32 needs 9
        private const int MaxExponent = 1000; // beyond, all is 0 or infinite
        private const int MaxWord = 40; // of what is repeated to people

        private readonly byte[] _text;
        private float[] _corners;
        private float[] _normals;
        private int _triangles;
        private int _start; // of the word at hand
        private int _end; // behind it

        internal StlTextReader(byte[] text)
        {
            _text = text;
            int expected = Math.Min(text.Length / UsualBytes + 1, StlReader.MaxTriangles);
            _corners = new float[9 * expected];
            _normals = new float[3 * expected];
        }

        /// <exception cref="StlException">In words, with the line.</exception>
        internal StlMesh Read()
        {
            Next();
            do
            {
                Expect("solid"); // some files have several
                SkipLine();
                ReadSolid();
            }
            while (Next());
            if (_triangles == 0)
            {
                throw new StlException("the STL has no triangles");
            }
            Array.Resize(ref _corners, 9 * _triangles);
            Array.Resize(ref _normals, 3 * _triangles);
            StlReader.MakeNormals(_corners, _normals, _triangles);
            return new StlMesh(_corners, _normals);
        }

        private void ReadSolid()
        {
            while (Next() && Is("facet"))
            {
                ReadFacet();
            }
            if (!Is("endsolid"))
            {
                throw Unexpected("facet or endsolid");
            }
            SkipLine(); // the name again
        }

        private void ReadFacet()
        {
            if (_triangles == StlReader.MaxTriangles)
            {
                throw new StlException("the STL has more than " + StlReader.MaxTriangles + " triangles");
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

        /// <summary>Goes to the next word; false if there is none.</summary>
        private bool Next()
        {
            byte[] text = _text;
            int at = _end;
            while (at < text.Length && text[at] <= ' ')
            {
                at++;
            }
            _start = at;
            while (at < text.Length && text[at] > ' ')
            {
                at++;
            }
            _end = at;
            return _start < at;
        }

        private void SkipLine()
        {
            while (_end < _text.Length && _text[_end] != '\n' && _text[_end] != '\r')
            {
                _end++;
            }
        }

        private void NextIs(string word)
        {
            Next();
            Expect(word);
        }

        private void Expect(string word)
        {
            if (!Is(word))
            {
                throw Unexpected(word);
            }
        }

        private bool Is(string word)
        {
            if (_end - _start != word.Length)
            {
                return false;
            }
            for (int i = 0; i < word.Length; i++)
            {
                if ((_text[_start + i] | 0x20) != word[i])
                {
                    return false;
                }
            }
            return true;
        }

        /// <summary>The next word as a number.</summary>
        /// <param name="isNormal">Whether anything else is NaN: programs write nan, -nan(ind) and the like there.</param>
        private float Number(bool isNormal)
        {
            Next();
            double value;
            bool isNumber = TryParse(out value) && !float.IsInfinity((float)value);
            if (!isNumber && (!isNormal || _start == _end))
            {
                throw Unexpected("a finite number");
            }
            return isNumber ? (float)value : float.NaN;
        }

        /// <summary>Whether the word is a number: [+-]digits[.digits][e[+-]digits], in every locale.</summary>
        private bool TryParse(out double value)
        {
            value = 0;
            int at = _start;
            bool isNegative = at < _end && _text[at] == '-';
            if (isNegative || (at < _end && _text[at] == '+'))
            {
                at++;
            }
            ulong mantissa = 0;
            long exponent = 0;
            int digits = 0; // of the mantissa, without zeros before it
            bool hasDigits = false, hasPoint = false;
            for (; at < _end; at++)
            {
                uint digit = (uint)(_text[at] - '0');
                if (digit > 9)
                {
                    if (_text[at] != '.' || hasPoint)
                    {
                        break;
                    }
                    hasPoint = true;
                    continue;
                }
                hasDigits = true;
                bool fits = digits < MaxDigits;
                if (fits)
                {
                    mantissa = 10 * mantissa + digit;
                    digits += mantissa > 0 ? 1 : 0;
                }
                exponent += (fits ? 0 : 1) - (hasPoint ? 1 : 0);
            }
            if (!hasDigits || (at < _end && !TryAddExponent(at, ref exponent)))
            {
                return false;
            }
            if (!FastDecimal.TryRound(mantissa, exponent, out value))
            {
                value = exponent < 0 ? 0 : double.PositiveInfinity; // far beyond what float32 has
            }
            value = isNegative ? -value : value;
            return true;
        }

        private bool TryAddExponent(int at, ref long exponent)
        {
            if ((_text[at] | 0x20) != 'e')
            {
                return false;
            }
            at++;
            bool isNegative = at < _end && _text[at] == '-';
            if (isNegative || (at < _end && _text[at] == '+'))
            {
                at++;
            }
            int first = at;
            int power = 0;
            for (; at < _end && (uint)(_text[at] - '0') <= 9; at++)
            {
                power = Math.Min(10 * power + (_text[at] - '0'), MaxExponent);
            }
            exponent += isNegative ? -power : power;
            return at > first && at == _end;
        }

        private StlException Unexpected(string expected)
        {
            int line = 1;
            for (int i = 0; i < _start; i++)
            {
                line += _text[i] == '\n' ? 1 : 0;
            }
            int count = Math.Min(_end - _start, MaxWord);
            string got = count == 0 ? "the end" : "'" + Encoding.ASCII.GetString(_text, _start, count) + "'";
            return new StlException("line " + line + " of the STL: expected " + expected + ", got " + got);
        }
    }
}
