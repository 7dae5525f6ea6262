// SPDX-License-Identifier: Apache-2.0
using System;
using System.Globalization;

namespace Ros2Gateway.Json
{
    public sealed partial class CborReader
    {
        private const byte FalseByte = 0xF4;
        private const byte TrueByte = 0xF5;
        private const byte NullByte = 0xF6;
        private const byte UndefinedByte = 0xF7;
        private const byte HalfByte = 0xF9;
        private const byte SingleByte = 0xFA;
        private const byte DoubleByte = 0xFB;

        /// <inheritdoc/>
        public override float ReadFloat32()
        {
            int start = _position;
            double value = ReadFloat64();
            float narrow = (float)value;
            if (float.IsInfinity(narrow) && !double.IsInfinity(value))
            {
                _position = start;
                throw Error("expected a float32, got " + value.ToString("R", CultureInfo.InvariantCulture));
            }
            return narrow;
        }

        /// <inheritdoc/>
        public override double ReadFloat64()
        {
            if (TryReadNull())
            {
                return double.NaN; // as in JSON, from a server that has no other way
            }
            bool isNegative;
            ulong magnitude;
            double value;
            if (!ReadNumber(out isNegative, out magnitude, out value))
            {
                return value;
            }
            return isNegative ? -(double)magnitude : magnitude;
        }

        internal override bool ReadNumber(out bool isNegative, out ulong magnitude, out double value)
        {
            int start = _position;
            int tag = _levels[_depth].ElementTag;
            if (tag != 0)
            {
                _position += ElementBytes(tag);
                return Element(tag, start, out isNegative, out magnitude, out value);
            }
            value = 0;
            isNegative = false;
            int major = start < _end ? Head(out magnitude) : HeadOfNothing(out magnitude);
            if (major == Unsigned)
            {
                return true;
            }
            if (major == Negative && magnitude <= long.MaxValue)
            {
                isNegative = true;
                magnitude++; // -1 has the argument 0
                return true;
            }
            if (major == Negative)
            {
                value = -1.0 - magnitude;
                return false;
            }
            switch (start < _end ? _buffer[start] : (byte)0)
            {
                case HalfByte:
                    value = Half((int)magnitude);
                    return false;
                case SingleByte:
                    value = BitConverter.ToSingle(BitConverter.GetBytes((uint)magnitude), 0);
                    return false;
                case DoubleByte:
                    value = BitConverter.Int64BitsToDouble((long)magnitude);
                    return false;
                default:
                    _position = start;
                    throw Unexpected("a number");
            }
        }

        internal override long ReadSigned(long least, long most)
        {
            int start = _position;
            bool isNegative;
            ulong magnitude;
            Whole(start, least, (ulong)most, out isNegative, out magnitude);
            return isNegative ? unchecked(-(long)magnitude) : (long)magnitude;
        }

        internal override ulong ReadUnsigned(ulong most)
        {
            int start = _position;
            bool isNegative;
            ulong magnitude;
            Whole(start, 0, most, out isNegative, out magnitude);
            return magnitude;
        }

        /// <summary>Reads an integer in a range. A float that is one counts, as 1.0 does in JSON.</summary>
        private void Whole(int start, long least, ulong most, out bool isNegative, out ulong magnitude)
        {
            double value;
            bool isWhole = ReadNumber(out isNegative, out magnitude, out value);
            if (!isWhole && value == Math.Floor(value) && Math.Abs(value) <= long.MaxValue)
            {
                isWhole = true;
                isNegative = value < 0;
                magnitude = (ulong)Math.Abs(value);
            }
            ulong limit = isNegative ? unchecked((ulong)-(least + 1) + 1) : most;
            if (isNegative && least == 0)
            {
                limit = 0;
            }
            if (!isWhole || magnitude > limit)
            {
                _position = start;
                throw Error("expected an integer from " + least.ToString(CultureInfo.InvariantCulture) + " to "
                    + most.ToString(CultureInfo.InvariantCulture) + ", got another number");
            }
        }

        internal override int TypedArray(int tag, int elementBytes)
        {
            int start = _position;
            int bytes;
            if (_levels[_depth].ElementTag == 0 && TakeTypedHead(out bytes) == tag && BitConverter.IsLittleEndian)
            {
                return bytes / elementBytes;
            }
            _position = start;
            return -1; // another one is read number by number
        }

        /// <summary>Goes to the bytes of a typed array. Its tag, or 0 if none comes next.</summary>
        private int TakeTypedHead(out int bytes)
        {
            bytes = 0;
            int start = _position;
            if (start >= _end || _buffer[start] >> 5 != Tag)
            {
                return 0;
            }
            ulong stated;
            Head(out stated);
            int tag = stated == 68 ? 64 : stated < 256 ? (int)stated : 0; // 68 is 64, clamped where it was made
            int elementBytes = ElementBytes(tag);
            if (elementBytes == 0)
            {
                _position = start;
                throw Error("tag " + stated + ", not a little-endian array of numbers");
            }
            int at = _position;
            ulong count;
            if (at >= _end || Head(out count) != Bytes)
            {
                _position = at;
                throw Unexpected("the octets of an array");
            }
            bytes = Fitting(count, start);
            if (bytes % elementBytes != 0)
            {
                _position = start;
                throw Error(bytes + " bytes are not an array of numbers of " + elementBytes + " bytes");
            }
            return tag;
        }

        // RFC 8746, 2.1
        private static int ElementBytes(int tag)
        {
            switch (tag)
            {
                case 64: // uint8
                case 72: // int8
                    return 1;
                case 69: // uint16
                case 77: // int16
                    return 2;
                case 70: // uint32
                case 78: // int32
                case 85: // float32
                    return 4;
                case 71: // uint64
                case 79: // int64
                case 86: // float64
                    return 8;
                default:
                    return 0;
            }
        }

        /// <summary>A number of a typed array. True for an integer.</summary>
        private bool Element(int tag, int at, out bool isNegative, out ulong magnitude, out double value)
        {
            isNegative = false;
            magnitude = 0;
            value = 0;
            if (tag == 85 || tag == 86)
            {
                value = tag == 85 ? BitConverter.ToSingle(_buffer, at) : BitConverter.ToDouble(_buffer, at);
                return false;
            }
            int bytes = ElementBytes(tag);
            for (int i = bytes - 1; i >= 0; i--)
            {
                magnitude = (magnitude << 8) | _buffer[at + i];
            }
            bool isSigned = tag >= 72;
            isNegative = isSigned && magnitude >> (8 * bytes - 1) == 1;
            if (isNegative)
            {
                magnitude = unchecked(0 - (magnitude | (bytes == 8 ? 0 : ulong.MaxValue << (8 * bytes))));
            }
            return true;
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
