// SPDX-License-Identifier: Apache-2.0
using System;
using System.Globalization;

namespace Ros2Gateway.Json
{
    public partial class JsonReader
    {
        private const long LargestExponent = 1000000000000; // no text is long enough to bring more back

        // The number that was scanned last. Its digits as they are, and its value as far as it fits,
        // _mantissa * 10^_exponent. _isExact is false where digits other than 0 were left out of it.
        private int _numberStart;
        private bool _isNegative;
        private ulong _mantissa;
        private long _exponent;
        private bool _isExact;

        /// <summary>Reads an integer from -128 to 127. 1.0 and 1e2 are integers too.</summary>
        public sbyte ReadInt8()
        {
            return (sbyte)ReadSigned(sbyte.MinValue, sbyte.MaxValue);
        }

        /// <summary>Reads an integer from 0 to 255.</summary>
        public byte ReadUInt8()
        {
            return (byte)ReadUnsigned(byte.MaxValue);
        }

        /// <summary>Reads an integer of 16 bits.</summary>
        public short ReadInt16()
        {
            return (short)ReadSigned(short.MinValue, short.MaxValue);
        }

        /// <summary>Reads an unsigned integer of 16 bits.</summary>
        public ushort ReadUInt16()
        {
            return (ushort)ReadUnsigned(ushort.MaxValue);
        }

        /// <summary>Reads an integer of 32 bits.</summary>
        public int ReadInt32()
        {
            return (int)ReadSigned(int.MinValue, int.MaxValue);
        }

        /// <summary>Reads an unsigned integer of 32 bits.</summary>
        public uint ReadUInt32()
        {
            return (uint)ReadUnsigned(uint.MaxValue);
        }

        /// <summary>Reads an integer of 64 bits, with all its digits.</summary>
        public long ReadInt64()
        {
            return ReadSigned(long.MinValue, long.MaxValue);
        }

        /// <summary>Reads an unsigned integer of 64 bits, with all its digits.</summary>
        public ulong ReadUInt64()
        {
            return ReadUnsigned(ulong.MaxValue);
        }

        /// <summary>
        /// Reads the single precision number nearest to what is written. Null is NaN, the texts "NaN",
        /// "Infinity" and "-Infinity" are what they name.
        /// </summary>
        public virtual float ReadFloat32()
        {
            double named;
            if (TryReadNonFinite(out named))
            {
                return (float)named;
            }
            ScanNumber("a number or null");
            double wide = ScannedDouble();
            // Rounding twice goes wrong only where the first rounding ends half way between two floats.
            bool isDoubtful = (BitConverter.DoubleToInt64Bits(wide) & 0x1FFFFFFF) == 0x10000000
                || (Math.Abs(wide) < ExactDecimal.SmallestNormalFloat && wide != 0);
            float value = isDoubtful
                ? (float)ExactDecimal.Round(_buffer, _numberStart, _position, ExactDecimal.FloatFormat)
                : (float)wide;
            if (float.IsInfinity(value))
            {
                throw OutOfRange("float32");
            }
            return value;
        }

        /// <summary>
        /// Reads the double precision number nearest to what is written. Null is NaN, the texts "NaN",
        /// "Infinity" and "-Infinity" are what they name.
        /// </summary>
        public virtual double ReadFloat64()
        {
            double named;
            if (TryReadNonFinite(out named))
            {
                return named;
            }
            ScanNumber("a number or null");
            return ScannedDouble();
        }

        /// <summary>Reads a number as an integer where it is written as one and has 64 bits.</summary>
        /// <returns>True for an integer: <paramref name="magnitude"/> and its sign. False for a double.
        /// </returns>
        internal virtual bool ReadNumber(out bool isNegative, out ulong magnitude, out double value)
        {
            SkipSpace();
            ScanNumber("a number");
            isNegative = _isNegative;
            magnitude = _mantissa;
            // -0 has a sign that only a double keeps: 0 - 1 is beyond the limit
            bool isWhole = _isExact && _exponent == 0 && (!_isNegative || _mantissa - 1 <= long.MaxValue);
            for (int i = _numberStart; isWhole && i < _position; i++)
            {
                isWhole = IsDigit(_buffer[i]) || _buffer[i] == (byte)'-';
            }
            value = isWhole ? 0 : ScannedDouble();
            return isWhole;
        }

        internal virtual long ReadSigned(long least, long most)
        {
            SkipSpace();
            int start = _position;
            ScanNumber("an integer");
            ulong magnitude = _mantissa;
            bool isWhole = (_exponent == 0 && _isExact) || MakeWhole(ref magnitude);
            ulong limit = _isNegative ? (ulong)-(least + 1) + 1 : (ulong)most;
            if (!isWhole || magnitude > limit)
            {
                throw NoInteger(start, Text(least), Text(most));
            }
            return _isNegative ? unchecked(-(long)magnitude) : (long)magnitude;
        }

        internal virtual ulong ReadUnsigned(ulong most)
        {
            SkipSpace();
            int start = _position;
            ScanNumber("an integer");
            ulong magnitude = _mantissa;
            bool isWhole = (_exponent == 0 && _isExact) || MakeWhole(ref magnitude);
            if (!isWhole || magnitude > most || (_isNegative && magnitude != 0))
            {
                throw NoInteger(start, "0", Text(most));
            }
            return magnitude;
        }

        /// <summary>Carries out the exponent. False if the number is not whole or beyond 64 bits.</summary>
        private bool MakeWhole(ref ulong magnitude)
        {
            if (!_isExact)
            {
                return false;
            }
            long exponent = magnitude == 0 ? 0 : _exponent;
            for (; exponent < 0; exponent++)
            {
                if (magnitude % 10 != 0)
                {
                    return false;
                }
                magnitude /= 10;
            }
            for (; exponent > 0; exponent--)
            {
                if (magnitude > ulong.MaxValue / 10)
                {
                    return false;
                }
                magnitude *= 10;
            }
            return true;
        }

        private double ScannedDouble()
        {
            double value;
            if (!_isExact || !FastDecimal.TryRound(_mantissa, _exponent, out value))
            {
                value = ExactDecimal.Round(_buffer, _numberStart, _position, ExactDecimal.DoubleFormat);
                if (double.IsInfinity(value))
                {
                    throw OutOfRange("float64");
                }
                return value;
            }
            return _isNegative ? -value : value;
        }

        private void ScanNumber(string expected)
        {
            byte[] buffer = _buffer;
            int end = _end;
            int at = _position;
            bool isNegative = at < end && buffer[at] == (byte)'-';
            if (isNegative)
            {
                at++;
            }
            int first = at;
            ulong mantissa = 0;
            uint digit;
            while (at < end && (digit = (uint)(buffer[at] - '0')) <= 9)
            {
                mantissa = mantissa * 10 + digit;
                at++;
            }
            if (at == first || (at > first + 1 && buffer[first] == (byte)'0'))
            {
                throw NoNumber(expected, at, first);
            }
            int digits = at - first;
            long exponent = 0;
            if (at < end && buffer[at] == (byte)'.')
            {
                at++;
                int point = at;
                if (mantissa == 0)
                {
                    digits = 0;
                    while (at < end && buffer[at] == (byte)'0')
                    {
                        at++;
                    }
                }
                int significant = at;
                while (at < end && (digit = (uint)(buffer[at] - '0')) <= 9)
                {
                    mantissa = mantissa * 10 + digit;
                    at++;
                }
                digits += at - significant;
                exponent = point - at;
                if (exponent == 0)
                {
                    _position = at;
                    throw Unexpected("a digit after the point");
                }
            }
            _isExact = true;
            if (digits > 19) // more may not fit into 64 bits
            {
                exponent = ScanLong(first, at, out mantissa);
            }
            if (at < end && (buffer[at] | 0x20) == 'e')
            {
                at = ScanExponent(at, ref exponent);
            }
            _numberStart = _position;
            _isNegative = isNegative;
            _mantissa = mantissa;
            _exponent = exponent;
            _position = at;
        }

        /// <summary>Takes as many digits as fit into 64 bits. Returns the exponent of ten that is left.
        /// </summary>
        private long ScanLong(int first, int end, out ulong mantissa)
        {
            mantissa = 0;
            long exponent = 0;
            bool isFraction = false;
            bool isFull = false;
            for (int i = first; i < end; i++)
            {
                if (_buffer[i] == (byte)'.')
                {
                    isFraction = true;
                    continue;
                }
                uint digit = (uint)(_buffer[i] - '0');
                isFull = isFull || mantissa > (ulong.MaxValue - digit) / 10;
                if (isFull)
                {
                    _isExact = _isExact && digit == 0;
                    exponent += isFraction ? 0 : 1;
                }
                else
                {
                    mantissa = mantissa * 10 + digit;
                    exponent -= isFraction ? 1 : 0;
                }
            }
            return exponent;
        }

        private int ScanExponent(int at, ref long exponent)
        {
            at++;
            bool isNegative = at < _end && _buffer[at] == (byte)'-';
            if (at < _end && (_buffer[at] == (byte)'-' || _buffer[at] == (byte)'+'))
            {
                at++;
            }
            int first = at;
            long value = 0;
            for (; at < _end && IsDigit(_buffer[at]); at++)
            {
                value = Math.Min(value * 10 + (_buffer[at] - '0'), LargestExponent);
            }
            if (at == first)
            {
                _position = at;
                throw Unexpected("a digit of the exponent");
            }
            exponent += isNegative ? -value : value;
            return at;
        }

        private bool TryReadNonFinite(out double value)
        {
            value = double.NaN;
            if (TryReadNull())
            {
                return true;
            }
            if (_position >= _end || _buffer[_position] != (byte)'"')
            {
                return false;
            }
            if (TakeLiteral("\"Infinity\""))
            {
                value = double.PositiveInfinity;
                return true;
            }
            if (TakeLiteral("\"-Infinity\""))
            {
                value = double.NegativeInfinity;
                return true;
            }
            return TakeLiteral("\"NaN\"");
        }

        private JsonFormatException NoNumber(string expected, int at, int first)
        {
            if (at > first)
            {
                return Error("a number begins with 0");
            }
            if (first > _position)
            {
                _position = first;
                return Unexpected("a digit after the minus");
            }
            return Unexpected(expected);
        }

        private static string Text(IFormattable number)
        {
            return number.ToString(null, CultureInfo.InvariantCulture);
        }

        private JsonFormatException NoInteger(int start, string least, string most)
        {
            string text = NumberText();
            _position = start;
            return Error("expected an integer from " + least + " to " + most + ", got " + text);
        }

        private JsonFormatException OutOfRange(string type)
        {
            string text = NumberText();
            _position = _numberStart;
            return Error("expected a " + type + ", got " + text);
        }

        private string NumberText()
        {
            int length = Math.Min(_position - _numberStart, LongestNameInPath);
            return PlainString(_numberStart, length);
        }
    }
}
