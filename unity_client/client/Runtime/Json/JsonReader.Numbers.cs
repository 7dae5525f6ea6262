// SPDX-License-Identifier: Apache-2.0
using System;
using System.Globalization;

namespace Ros2Gateway.Json
{
    public partial class JsonReader
    {
        private const long LargestExponent = 1000000000000; // no text is long enough to bring more back

        /// <summary>The start of the number that was read last.</summary>
        private protected int _numberStart;

        // The number that was scanned last. Its value as far as it fits, _mantissa * 10^_exponent. _isExact is false
        // where digits other than 0 were left out of it.
        private bool _isNegative;
        private ulong _mantissa;
        private long _exponent;
        private bool _isExact;
        private bool _hasOnlyDigits;

        /// <summary>Reads an integer from -128 to 127. 1.0 and 1e2 are integers too.</summary>
        public sbyte ReadInt8() => (sbyte)ReadSigned(sbyte.MinValue, (ulong)sbyte.MaxValue);

        /// <summary>Reads an integer from 0 to 255.</summary>
        public byte ReadUInt8() => (byte)ReadWhole(0, byte.MaxValue, out _);

        /// <summary>Reads an integer of 16 bits.</summary>
        public short ReadInt16() => (short)ReadSigned(short.MinValue, (ulong)short.MaxValue);

        /// <summary>Reads an unsigned integer of 16 bits.</summary>
        public ushort ReadUInt16() => (ushort)ReadWhole(0, ushort.MaxValue, out _);

        /// <summary>Reads an integer of 32 bits.</summary>
        public int ReadInt32() => (int)ReadSigned(int.MinValue, int.MaxValue);

        /// <summary>Reads an unsigned integer of 32 bits.</summary>
        public uint ReadUInt32() => (uint)ReadWhole(0, uint.MaxValue, out _);

        /// <summary>Reads an integer of 64 bits, with all its digits.</summary>
        public long ReadInt64() => ReadSigned(long.MinValue, long.MaxValue);

        /// <summary>Reads an unsigned integer of 64 bits, with all its digits.</summary>
        public ulong ReadUInt64() => ReadWhole(0, ulong.MaxValue, out _);

        /// <summary>
        /// Reads the single precision number nearest to what is written. Null is NaN, the texts "NaN",
        /// "Infinity" and "-Infinity" are what they name.
        /// </summary>
        public float ReadFloat32()
        {
            double value = ReadFloat64();
            float narrow = (float)value;
            return float.IsInfinity(narrow) && !double.IsInfinity(value) ? throw OutOfRange("a float32") : narrow;
        }

        /// <summary>
        /// Reads the double precision number nearest to what is written. Null is NaN, the texts "NaN",
        /// "Infinity" and "-Infinity" are what they name.
        /// </summary>
        public virtual double ReadFloat64()
        {
            SkipSpace();
            byte next = _position < _end ? _buffer[_position] : (byte)0;
            if (next != (byte)'n' && next != (byte)'"')
            {
                ScanNumber("a number or null");
                return ScannedDouble();
            }
            return TakeLiteral("null") || TakeLiteral("\"NaN\"") ? double.NaN
                : TakeLiteral("\"Infinity\"") ? double.PositiveInfinity
                : TakeLiteral("\"-Infinity\"") ? double.NegativeInfinity : throw Unexpected("a number or null");
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
            bool isWhole = _hasOnlyDigits && _exponent == 0 && _isExact
                && (!isNegative || magnitude - 1 <= long.MaxValue);
            value = isWhole ? 0 : ScannedDouble();
            return isWhole;
        }

        /// <summary>Reads a number. Returns whether it is an integer of 64 bits, however it is written.</summary>
        private protected virtual bool ReadInteger(out bool isNegative, out ulong magnitude)
        {
            SkipSpace();
            ScanNumber("an integer");
            isNegative = _isNegative;
            magnitude = _mantissa;
            bool isWhole = _isExact;
            long exponent = magnitude == 0 ? 0 : _exponent;
            for (; isWhole && exponent < 0; exponent++)
            {
                isWhole = magnitude % 10 == 0;
                magnitude /= 10;
            }
            for (; isWhole && exponent > 0; exponent--)
            {
                isWhole = magnitude <= ulong.MaxValue / 10;
                magnitude *= 10;
            }
            return isWhole;
        }

        /// <summary>The number that was read last, for people.</summary>
        private protected virtual string NumberText() =>
            PlainString(_numberStart, Math.Min(_position - _numberStart, LongestNameInPath));

        private long ReadSigned(long least, ulong most)
        {
            ulong magnitude = ReadWhole(least, most, out bool isNegative);
            return isNegative ? unchecked(-(long)magnitude) : (long)magnitude;
        }

        private ulong ReadWhole(long least, ulong most, out bool isNegative)
        {
            bool isWhole = ReadInteger(out isNegative, out ulong magnitude);
            if (!isWhole || magnitude > (isNegative ? unchecked(0UL - (ulong)least) : most))
            {
                throw OutOfRange(string.Format(
                    CultureInfo.InvariantCulture, "an integer from {0} to {1}", least, most));
            }
            return magnitude;
        }

        private double ScannedDouble()
        {
            double value = _isExact ? DecimalText.Exact(_mantissa, _exponent) : double.NaN;
            if (double.IsNaN(value))
            {
                value = DecimalText.Parse(_buffer, _isNegative ? _numberStart + 1 : _numberStart, _position);
            }
            return double.IsInfinity(value) ? throw OutOfRange("a float64") : _isNegative ? -value : value;
        }

        private void ScanNumber(string expected)
        {
            int at = _position;
            _numberStart = at;
            _isNegative = at < _end && _buffer[at] == (byte)'-';
            _mantissa = 0;
            _exponent = 0;
            _isExact = true;
            int first = _isNegative ? at + 1 : at;
            at = ScanDigits(first, 0, _isNegative ? "a digit after the minus" : expected);
            if (at > first + 1 && _buffer[first] == (byte)'0')
            {
                throw Error("a number begins with 0");
            }
            int whole = at;
            if (at < _end && _buffer[at] == (byte)'.')
            {
                at = ScanDigits(at + 1, 1, "a digit after the point");
            }
            if (at < _end && (_buffer[at] | 0x20) == 'e')
            {
                at = ScanExponent(at + 1);
            }
            _hasOnlyDigits = at == whole;
            _position = at;
        }

        /// <summary>Takes the digits that fit into 64 bits. Each takes so many places from the exponent.</summary>
        private int ScanDigits(int first, int places, string expected)
        {
            const ulong Largest = ulong.MaxValue / 10;
            byte[] buffer = _buffer;
            int end = _end;
            ulong mantissa = _mantissa;
            int at = first;
            uint digit;
            for (; at < end && (digit = (uint)(buffer[at] - '0')) <= 9; at++)
            {
                if (mantissa < Largest || (mantissa == Largest && digit <= ulong.MaxValue % 10 && _isExact))
                {
                    mantissa = mantissa * 10 + digit;
                    continue;
                }
                _isExact &= digit == 0;
                _exponent++;
            }
            if (at == first)
            {
                _position = first;
                throw Unexpected(expected);
            }
            _mantissa = mantissa;
            _exponent -= places * (at - first);
            return at;
        }

        private int ScanExponent(int at)
        {
            byte sign = at < _end ? _buffer[at] : (byte)0;
            at += sign == (byte)'-' || sign == (byte)'+' ? 1 : 0;
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
            _exponent += sign == (byte)'-' ? -value : value;
            return at;
        }

        private JsonFormatException OutOfRange(string expected)
        {
            string text = NumberText();
            _position = _numberStart;
            return Error("expected " + expected + ", got " + text);
        }
    }
}
