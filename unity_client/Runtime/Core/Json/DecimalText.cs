// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway.Json
{
    /// <summary>Writes numbers as JSON has them, into a buffer with room for them.</summary>
    internal static class DecimalText
    {
        /// <summary>The length of the longest number: sign, 17 digits, point and zeros before or an exponent.
        /// </summary>
        internal const int LongestNumber = 32;

        private const int LeastPlainExponent = -5; // 0.00001 is plain, 1e-6 is not
        private const int MostPlainExponent = 15;

        /// <summary>Returns the position behind what it wrote.</summary>
        internal static int WriteUInt64(byte[] buffer, int at, ulong value)
        {
            int end = at + CountDigits(value);
            for (int i = end - 1; i >= at; i--)
            {
                ulong tenth = value / 10;
                buffer[i] = (byte)('0' + (value - tenth * 10));
                value = tenth;
            }
            return end;
        }

        /// <summary>Returns the position behind what it wrote.</summary>
        internal static int WriteInt64(byte[] buffer, int at, long value)
        {
            if (value >= 0)
            {
                return WriteUInt64(buffer, at, (ulong)value);
            }
            buffer[at] = (byte)'-';
            return WriteUInt64(buffer, at + 1, unchecked(0UL - (ulong)value));
        }

        /// <summary>Writes a finite double. Returns the position behind it.</summary>
        internal static int Write(byte[] buffer, int at, double value)
        {
            if (BitConverter.DoubleToInt64Bits(value) < 0)
            {
                buffer[at++] = (byte)'-';
                value = -value;
            }
            int exponent = 0;
            return Write(buffer, at, value == 0 ? 0 : ShortestDecimal.Of(value, out exponent), exponent);
        }

        /// <summary>Writes a finite float. Returns the position behind it.</summary>
        internal static int Write(byte[] buffer, int at, float value)
        {
            if (BitConverter.DoubleToInt64Bits(value) < 0)
            {
                buffer[at++] = (byte)'-';
                value = -value;
            }
            int exponent = 0;
            return Write(buffer, at, value == 0 ? 0 : ShortestDecimal.Of(value, out exponent), exponent);
        }

        /// <summary>Writes digits * 10^exponent with a point or an exponent, so that it reads as a float.
        /// </summary>
        private static int Write(byte[] buffer, int at, ulong digits, int exponent)
        {
            while (digits != 0 && digits % 10 == 0)
            {
                digits /= 10;
                exponent++;
            }
            int count = CountDigits(digits);
            int first = count - 1 + exponent; // the exponent of the first digit
            if (first < LeastPlainExponent || first > MostPlainExponent)
            {
                int end = WriteUInt64(buffer, at + 1, digits);
                buffer[at] = buffer[at + 1];
                buffer[at + 1] = (byte)'.';
                buffer[end] = (byte)'e';
                return WriteInt64(buffer, count == 1 ? WithoutPoint(buffer, at) : end + 1, first);
            }
            if (first < 0)
            {
                int digitsAt = at + 1 - first; // behind "0." and -1 - first zeros
                for (int i = at; i < digitsAt; i++)
                {
                    buffer[i] = (byte)'0';
                }
                buffer[at + 1] = (byte)'.';
                return WriteUInt64(buffer, digitsAt, digits);
            }
            if (exponent < 0)
            {
                int end = WriteUInt64(buffer, at + 1, digits);
                int point = at + first + 1;
                for (int i = at; i < point; i++)
                {
                    buffer[i] = buffer[i + 1];
                }
                buffer[point] = (byte)'.';
                return end;
            }
            at = WriteUInt64(buffer, at, digits);
            for (; exponent > 0; exponent--)
            {
                buffer[at++] = (byte)'0';
            }
            buffer[at++] = (byte)'.';
            buffer[at++] = (byte)'0';
            return at;
        }

        private static int WithoutPoint(byte[] buffer, int at)
        {
            buffer[at + 1] = (byte)'e';
            return at + 2;
        }

        private static int CountDigits(ulong value)
        {
            int count = 1;
            while (value >= 10000)
            {
                value /= 10000;
                count += 4;
            }
            return value >= 1000 ? count + 3 : value >= 100 ? count + 2 : value >= 10 ? count + 1 : count;
        }
    }
}
