// SPDX-License-Identifier: Apache-2.0
using System;
using System.Globalization;

namespace Ros2Gateway.Json
{
    public sealed partial class CborReader
    {
        private const int LargestInteger = (Bytes << 5) - 1; // first byte
        private const int FalseByte = 0xF4;
        private const int TrueByte = 0xF5;
        private const int NullByte = 0xF6;
        private const int UndefinedByte = 0xF7;
        private const int HalfByte = 0xF9;
        private const int SingleByte = 0xFA;
        private const int DoubleByte = 0xFB;

        private const int UInt8 = 64; // tags of RFC 8746, 2.1
        private const int ClampedUInt8 = 68;
        private const int Int8 = 72;
        private const int Float32 = 85;
        private const int Float64 = 86;

        /// <inheritdoc/>
        public override double ReadFloat64() =>
            TryReadNull() ? double.NaN // as in JSON, from a server that has no other way
                : !ReadNumber(out bool isNegative, out ulong magnitude, out double value) ? value
                : isNegative ? -(double)magnitude : magnitude;

        internal override bool ReadNumber(out bool isNegative, out ulong magnitude, out double value)
        {
            _numberStart = _position;
            int tag = _levels[_depth].ElementTag;
            if (tag != 0)
            {
                return Element(tag, out isNegative, out magnitude, out value);
            }
            int head = NextHead;
            if (head < 0 || (head > LargestInteger && head != HalfByte && head != SingleByte && head != DoubleByte))
            {
                throw Unexpected("a number");
            }
            int major = Head(out magnitude);
            isNegative = major == Negative && magnitude <= long.MaxValue;
            if (isNegative || major == Unsigned)
            {
                magnitude += isNegative ? 1UL : 0; // -1 has the argument 0
                value = 0;
                return true;
            }
            value = head switch
            {
                DoubleByte => BitConverter.Int64BitsToDouble((long)magnitude),
                SingleByte => BitConverter.Int32BitsToSingle((int)magnitude),
                HalfByte => Half((int)magnitude),
                _ => -1.0 - magnitude, // beyond 64 bits
            };
            return false;
        }

        /// <inheritdoc/>
        private protected override bool ReadInteger(out bool isNegative, out ulong magnitude)
        {
            if (ReadNumber(out isNegative, out magnitude, out double value))
            {
                return true;
            }
            isNegative = value < 0;
            magnitude = unchecked((ulong)Math.Abs(value));
            return value == Math.Floor(value) && Math.Abs(value) <= long.MaxValue;
        }

        private protected override string NumberText()
        {
            _position = _numberStart;
            bool isWhole = ReadNumber(out bool isNegative, out ulong magnitude, out double value);
            return isWhole ? (isNegative ? "-" : "") + magnitude : value.ToString("R", CultureInfo.InvariantCulture);
        }

        private protected override int TypedArray(int tag)
        {
            int start = _position;
            if (TakeTypedHead(out int bytes) == tag && BitConverter.IsLittleEndian)
            {
                return bytes / ElementBytes(tag);
            }
            _position = start;
            return -1; // another one is read number by number
        }

        /// <summary>Goes to the bytes of a typed array. Its tag, or 0 if none comes next.</summary>
        private int TakeTypedHead(out int bytes)
        {
            bytes = 0;
            int start = _position;
            if (NextHead >> 5 != Tag)
            {
                return 0;
            }
            Head(out ulong stated);
            int tag = stated == ClampedUInt8 ? UInt8 : (int)Math.Min(stated, byte.MaxValue);
            int elementBytes = ElementBytes(tag);
            if (elementBytes == 0)
            {
                _position = start;
                throw Error("tag " + stated + ", not a little-endian array of numbers");
            }
            bytes = Sized(Bytes, "the octets of an array");
            if (bytes % elementBytes != 0)
            {
                _position = start;
                throw Error(bytes + " bytes are not an array of numbers of " + elementBytes + " bytes");
            }
            return tag;
        }

        // Tags are 0b010fsell: float, signed, little-endian, and the length, twice as long for floats.
        private static int ElementBytes(int tag) =>
            tag is UInt8 or (> ClampedUInt8 and <= Int8) or (> 76 and < 80) or Float32 or Float64
                ? 1 << ((tag >> 4 & 1) + (tag & 3)) : 0;

        /// <summary>A number of a typed array. True for an integer.</summary>
        private bool Element(int tag, out bool isNegative, out ulong magnitude, out double value)
        {
            int bytes = ElementBytes(tag);
            magnitude = 0;
            for (int i = bytes - 1; i >= 0; i--)
            {
                magnitude = (magnitude << 8) | _buffer[_position + i];
            }
            value = tag switch
            {
                Float32 => BitConverter.Int32BitsToSingle((int)magnitude),
                Float64 => BitConverter.Int64BitsToDouble((long)magnitude),
                _ => 0,
            };
            _position += bytes;
            isNegative = tag is >= Int8 and < Float32 && magnitude >> (8 * bytes - 1) == 1;
            if (isNegative)
            {
                magnitude = unchecked(0 - (magnitude | (bytes == 8 ? 0 : ulong.MaxValue << (8 * bytes))));
            }
            return tag < Float32;
        }

        // RFC 8949, appendix D
        private static double Half(int bits)
        {
            int exponent = (bits >> 10) & 31;
            int mantissa = bits & 1023;
            double value = exponent == 0 ? mantissa * Math.Pow(2, -24)
                : exponent < 31 ? (mantissa + 1024) * Math.Pow(2, exponent - 25)
                : mantissa == 0 ? double.PositiveInfinity : double.NaN;
            return bits >> 15 == 1 ? -value : value;
        }
    }
}
