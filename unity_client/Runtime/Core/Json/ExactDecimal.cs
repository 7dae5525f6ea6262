// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway.Json
{
    /// <summary>
    /// Decimal numbers and binary floats turned into each other with as many bits as it takes. Slow and
    /// obvious: for the few numbers about which <see cref="FastDecimal"/> and <see cref="ShortestDecimal"/>
    /// say nothing.
    /// </summary>
    /// <remarks>
    /// .NET's own would be less code, and wrong. Of doubles outside their table, written shortest, Mono 6.8's
    /// <c>double.Parse</c> misreads 0.9 % of the normal and 44 % of the subnormal ones. Its <c>ToString("R")</c> writes
    /// 0.1 % and 1.3 % of them as another number.
    /// </remarks>
    internal static class ExactDecimal
    {
        internal const float SmallestNormalFloat = 1.17549435E-38f;

        /// <summary>Digits of a number that are looked at: half way between two doubles takes at most 767.
        /// </summary>
        private const int MostDigits = 800;
        private const int LargestExponent = 310; // of the first digit: 1e310 is infinite
        private const int LeastExponent = -326; // 9e-326 is far below half the smallest double

        internal static readonly Format DoubleFormat = new Format(53, -1074, 971);
        internal static readonly Format FloatFormat = new Format(24, -149, 104);

        /// <summary>
        /// Rounds a JSON number, which must be well-formed, to the nearest of a format, ties to even.
        /// </summary>
        internal static double Round(byte[] text, int start, int end, Format format)
        {
            bool isNegative = text[start] == (byte)'-';
            double value = RoundMagnitude(text, isNegative ? start + 1 : start, end, format);
            return isNegative ? -value : value;
        }

        /// <summary>
        /// Writes mantissa * 2^exponent as decimal digits, of which the first is not 0, cut off after the
        /// last that there is room for.
        /// </summary>
        /// <returns>The exponent of ten of the first digit.</returns>
        internal static int Digits(ulong mantissa, int exponent, byte[] digits)
        {
            var numerator = new Natural(mantissa);
            var denominator = new Natural(1);
            (exponent >= 0 ? numerator : denominator).ShiftLeft(Math.Abs(exponent));
            // one less, so that an error of the logarithm cannot make it too large
            int power = (int)Math.Floor((exponent + Math.Log(mantissa, 2)) * 0.30102999566398120) - 1;
            (power >= 0 ? denominator : numerator).MultiplyByPowerOfTen(Math.Abs(power));
            var tenfold = new Natural(denominator);
            tenfold.MultiplyAdd(10, 0);
            while (numerator.CompareTo(tenfold) >= 0)
            {
                denominator.MultiplyAdd(10, 0);
                tenfold.MultiplyAdd(10, 0);
                power++;
            }
            for (int i = 0; i < digits.Length; i++)
            {
                byte digit = 0;
                while (numerator.CompareTo(denominator) >= 0)
                {
                    numerator.Subtract(denominator);
                    digit++;
                }
                digits[i] = digit;
                numerator.MultiplyAdd(10, 0);
            }
            return power;
        }

        private static double RoundMagnitude(byte[] text, int start, int end, Format format)
        {
            var numerator = new Natural(0);
            long exponent;
            int digits = Collect(text, start, end, numerator, out exponent);
            if (digits == 0 || exponent + digits <= LeastExponent)
            {
                return 0;
            }
            if (exponent + digits > LargestExponent)
            {
                return double.PositiveInfinity;
            }
            var denominator = new Natural(1);
            (exponent >= 0 ? numerator : denominator).MultiplyByPowerOfTen((int)Math.Abs(exponent));

            // 64 bits of the quotient, which lies in [1, 2) * 2^binary
            int binary = numerator.BitLength - denominator.BitLength;
            (binary >= 0 ? denominator : numerator).ShiftLeft(Math.Abs(binary));
            if (numerator.CompareTo(denominator) < 0)
            {
                numerator.ShiftLeft(1);
                binary--;
            }
            ulong quotient = 0;
            for (int i = 0; i < 64; i++)
            {
                quotient <<= 1;
                if (numerator.CompareTo(denominator) >= 0)
                {
                    numerator.Subtract(denominator);
                    quotient |= 1;
                }
                numerator.ShiftLeft(1);
            }
            return format.Nearest(quotient, binary - 63, !numerator.IsZero);
        }

        /// <summary>Reads digits and exponent. Returns how many digits the value got.</summary>
        private static int Collect(byte[] text, int start, int end, Natural value, out long exponent)
        {
            int digits = 0;
            bool isFraction = false;
            bool hasMore = false;
            exponent = 0;
            int at = start;
            for (; at < end && (text[at] | 0x20) != 'e'; at++)
            {
                if (text[at] == (byte)'.')
                {
                    isFraction = true;
                    continue;
                }
                int digit = text[at] - '0';
                if (digits < MostDigits)
                {
                    exponent -= isFraction ? 1 : 0;
                    if (digits > 0 || digit > 0)
                    {
                        value.MultiplyAdd(10, (uint)digit);
                        digits++;
                    }
                }
                else
                {
                    exponent += isFraction ? 0 : 1;
                    hasMore |= digit > 0;
                }
            }
            if (hasMore) // one more digit stands for all that were left out
            {
                value.MultiplyAdd(10, 1);
                digits++;
                exponent--;
            }
            exponent += ReadExponent(text, at + 1, end);
            return digits;
        }

        private static long ReadExponent(byte[] text, int at, int end)
        {
            long value = 0;
            bool isNegative = at < end && text[at] == (byte)'-';
            for (; at < end; at++)
            {
                if (text[at] >= (byte)'0')
                {
                    value = Math.Min(value * 10 + (text[at] - '0'), 1000000000000);
                }
            }
            return isNegative ? -value : value;
        }

        /// <summary>A binary floating point format.</summary>
        internal sealed class Format
        {
            private readonly int _precision;
            private readonly int _least;
            private readonly int _most;

            /// <summary>Bits of the mantissa, and the exponents of its lowest bit.</summary>
            internal Format(int precision, int least, int most)
            {
                _precision = precision;
                _least = least;
                _most = most;
            }

            /// <summary>Rounds bits * 2^exponent and a little more (if there is). The highest bit is set.
            /// </summary>
            internal double Nearest(ulong bits, int exponent, bool hasMore)
            {
                int dropped = Math.Max(64 - _precision, _least - exponent);
                if (dropped > 64)
                {
                    return 0;
                }
                ulong kept = dropped == 64 ? 0 : bits >> dropped;
                ulong half = 1UL << (dropped - 1);
                ulong rest = dropped == 64 ? bits : bits & ((half << 1) - 1);
                if (rest > half || (rest == half && (hasMore || (kept & 1) == 1)))
                {
                    kept++;
                }
                exponent += dropped;
                if (kept == 1UL << _precision)
                {
                    kept >>= 1;
                    exponent++;
                }
                return exponent > _most ? double.PositiveInfinity : Scaled(kept, exponent);
            }

            /// <summary>Returns kept * 2^exponent, which is a double exactly.</summary>
            private static double Scaled(ulong kept, int exponent)
            {
                if (kept == 0)
                {
                    return 0;
                }
                while (kept < 1UL << 52 && exponent > -1074)
                {
                    kept <<= 1;
                    exponent--;
                }
                ulong biased = kept < 1UL << 52 ? 0 : (ulong)(exponent + 1075);
                return BitConverter.Int64BitsToDouble((long)((biased << 52) | (kept & ((1UL << 52) - 1))));
            }
        }

        /// <summary>A natural number of any length up to what decimal numbers with limits need.</summary>
        private sealed class Natural
        {
            private readonly uint[] _limbs = new uint[128]; // 10^(326 + 801) and shifts have 3800 bits
            private int _count;

            internal Natural(ulong value)
            {
                _limbs[0] = (uint)value;
                _limbs[1] = (uint)(value >> 32);
                _count = _limbs[1] != 0 ? 2 : _limbs[0] != 0 ? 1 : 0;
            }

            internal Natural(Natural other)
            {
                Array.Copy(other._limbs, _limbs, other._count);
                _count = other._count;
            }

            internal bool IsZero
            {
                get { return _count == 0; }
            }

            internal int BitLength
            {
                get
                {
                    int bits = 0;
                    for (uint top = _count == 0 ? 0 : _limbs[_count - 1]; top != 0; top >>= 1)
                    {
                        bits++;
                    }
                    return 32 * Math.Max(_count - 1, 0) + bits;
                }
            }

            internal void MultiplyAdd(uint factor, uint summand)
            {
                ulong carry = summand;
                for (int i = 0; i < _count; i++)
                {
                    carry += (ulong)_limbs[i] * factor;
                    _limbs[i] = (uint)carry;
                    carry >>= 32;
                }
                if (carry != 0)
                {
                    _limbs[_count++] = (uint)carry;
                }
            }

            internal void MultiplyByPowerOfTen(int power)
            {
                for (; power >= 9; power -= 9)
                {
                    MultiplyAdd(1000000000, 0);
                }
                for (; power > 0; power--)
                {
                    MultiplyAdd(10, 0);
                }
            }

            internal void ShiftLeft(int bits)
            {
                int limbs = bits / 32;
                if (limbs > 0 && _count > 0)
                {
                    Array.Copy(_limbs, 0, _limbs, limbs, _count);
                    Array.Clear(_limbs, 0, limbs);
                    _count += limbs;
                }
                MultiplyAdd(1u << (bits % 32), 0);
            }

            /// <summary>Subtracts a number that is not larger.</summary>
            internal void Subtract(Natural other)
            {
                long borrow = 0;
                for (int i = 0; i < _count; i++)
                {
                    borrow += (long)_limbs[i] - other._limbs[i];
                    _limbs[i] = (uint)borrow;
                    borrow >>= 32;
                }
                while (_count > 0 && _limbs[_count - 1] == 0)
                {
                    _count--;
                }
            }

            internal int CompareTo(Natural other)
            {
                if (_count != other._count)
                {
                    return _count.CompareTo(other._count);
                }
                for (int i = _count - 1; i >= 0; i--)
                {
                    if (_limbs[i] != other._limbs[i])
                    {
                        return _limbs[i].CompareTo(other._limbs[i]);
                    }
                }
                return 0;
            }
        }
    }
}
