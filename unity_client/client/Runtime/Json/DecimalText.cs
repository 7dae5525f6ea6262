// SPDX-License-Identifier: Apache-2.0
using System;
using System.Globalization;
using System.Text;

namespace Ros2Gateway.Json
{
    /// <summary>Writes numbers as JSON has them, into a buffer with room for them, and reads them.</summary>
    internal static class DecimalText
    {
        /// <summary>The length of the longest number: sign, digits, point, zeros before them or an exponent.</summary>
        internal const int LongestNumber = 32;

        private const ulong LargestExact = 1UL << 53; // up to here every integer is a double
        private const int LongestOnStack = 64; // characters

        // Those that are doubles. An exact number times or by one of them rounds once.
        private static readonly double[] PowersOfTen =
        {
            1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11,
            1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
        };

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

        /// <summary>Writes a finite double, or a finite float in fewer digits. Returns the position behind it.</summary>
        internal static int Write(byte[] buffer, int at, double value, bool isSingle)
        {
            if (BitConverter.DoubleToInt64Bits(value) < 0)
            {
                buffer[at++] = (byte)'-';
                value = -value;
            }
            for (int decimals = 0; decimals < PowersOfTen.Length; decimals++)
            {
                double digits = Math.Round(value * PowersOfTen[decimals]);
                if (digits > LargestExact)
                {
                    break;
                }
                double read = digits / PowersOfTen[decimals];
                if (isSingle ? (float)read == (float)value : read == value)
                {
                    return WriteFixed(buffer, at, (ulong)digits, decimals);
                }
            }
            // 17 digits: with "R", Mono tries 15 first, and reads them back wrong at times
            Span<char> text = stackalloc char[LongestNumber];
            value.TryFormat(text, out int count, isSingle ? "G9" : "G17", CultureInfo.InvariantCulture);
            text = text.Slice(0, count);
            at += Encoding.ASCII.GetBytes(text, new Span<byte>(buffer, at, count));
            if (text.IndexOfAny('.', 'E') < 0)
            {
                buffer[at++] = (byte)'.';
                buffer[at++] = (byte)'0';
            }
            return at;
        }

        /// <summary>Returns mantissa * 10^exponent. NaN if only <see cref="Parse"/> can.</summary>
        internal static double Exact(ulong mantissa, long exponent)
        {
            if (mantissa > long.MaxValue || exponent <= -PowersOfTen.Length || exponent >= PowersOfTen.Length)
            {
                return double.NaN;
            }
            if (mantissa <= LargestExact)
            {
                return exponent < 0 ? (long)mantissa / PowersOfTen[-exponent] : (long)mantissa * PowersOfTen[exponent];
            }
            return exponent < 0 ? Quotient((long)mantissa, (int)-exponent) : double.NaN;
        }

        // The division rounds twice, so it can miss the nearest double by one step. The remainder decides. It is a few
        // steps at most, so its 64 bits are right, although its two parts have more.
        private static double Quotient(long mantissa, int places)
        {
            long five = 1; // to the places: that much is a step
            for (int i = 0; i < places; i++)
            {
                five *= 5;
            }
            long bits = BitConverter.DoubleToInt64Bits(mantissa / PowersOfTen[places]);
            long leading = 1L << 52;
            long digits = leading | (bits & (leading - 1));
            int shift = 1075 - places - (int)(bits >> 52);
            if (shift < 0 || digits == leading) // below a power of two steps are half as long
            {
                return double.NaN;
            }
            long rest = unchecked((shift < 64 ? mantissa << shift : 0) - digits * five);
            int step = rest > five / 2 ? 1 : rest < -(five / 2) ? -1 : 0;
            return BitConverter.Int64BitsToDouble(bits + step);
        }

        /// <summary>Reads a number of JSON. An infinity if it is beyond the range.</summary>
        internal static double Parse(byte[] buffer, int at, int end)
        {
            int length = end - at;
            Span<char> text = length <= LongestOnStack ? stackalloc char[length] : new char[length];
            for (int i = 0; i < length; i++)
            {
                text[i] = (char)buffer[at + i];
            }
            return double.TryParse(text, NumberStyles.Float, CultureInfo.InvariantCulture, out double value)
                ? value : double.PositiveInfinity;
        }

        // Digits with a point, so that it reads as a float, and with zeros before them.
        private static int WriteFixed(byte[] buffer, int at, ulong digits, int decimals)
        {
            if (decimals == 0)
            {
                digits *= 10;
                decimals = 1;
            }
            int end = at + Math.Max(CountDigits(digits), decimals + 1) + 1;
            for (int i = end - 1; i >= at; i--)
            {
                if (i == end - 1 - decimals)
                {
                    buffer[i] = (byte)'.';
                    continue;
                }
                buffer[i] = (byte)('0' + digits % 10);
                digits /= 10;
            }
            return end;
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
