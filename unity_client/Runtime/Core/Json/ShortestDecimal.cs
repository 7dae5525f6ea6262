// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway.Json
{
    /// <summary>
    /// The shortest decimal number that reads back as a given float, and of these the nearest: Schubfach
    /// (Giulietti, The Schubfach way to render doubles, 2020), by integers only.
    /// </summary>
    internal static class ShortestDecimal
    {
        private const int DoubleDigits = 17; // are enough for any double

        /// <summary>Finds digits * 10^exponent for a double that is finite and positive.</summary>
        internal static ulong Of(double value, out int exponent)
        {
            ulong bits = (ulong)BitConverter.DoubleToInt64Bits(value);
            ulong fraction = bits & ((1UL << 52) - 1);
            int biased = (int)(bits >> 52);
            ulong mantissa = biased == 0 ? fraction : fraction | (1UL << 52);
            int power = Math.Max(biased, 1) - 1075;
            bool isLowerCloser = fraction == 0 && biased > 1;
            ulong digits;
            return TryOf(mantissa, power, isLowerCloser, out digits, out exponent)
                ? digits
                : OfRare(value, mantissa, power, out exponent);
        }

        /// <summary>Finds digits * 10^exponent for a float that is finite and positive.</summary>
        internal static ulong Of(float value, out int exponent)
        {
            // A float is a double with 29 zeros behind, unless it is subnormal.
            ulong bits = (ulong)BitConverter.DoubleToInt64Bits(value);
            int power = (int)(bits >> 52) - 1075 + 29;
            ulong mantissa = ((bits & ((1UL << 52) - 1)) | (1UL << 52)) >> 29;
            bool isLowerCloser = mantissa == 1UL << 23 && power > -149;
            if (power < -149)
            {
                mantissa >>= -149 - power;
                power = -149;
                isLowerCloser = false;
            }
            ulong digits;
            TryOf(mantissa, power, isLowerCloser, out digits, out exponent);
            return digits;
        }

        /// <summary>
        /// False if the table of powers does not reach. The names are those of the paper: s and its
        /// neighbours in [lower, upper], all times four, so that halves are whole.
        /// </summary>
        private static bool TryOf(ulong mantissa, int power, bool isLowerCloser, out ulong digits, out int k)
        {
            k = (power * 1262611 - (isLowerCloser ? 524031 : 0)) >> 22; // log10(2^power), or of 3/4 of it
            digits = 0;
            if (-k < PowersOfTen.Least || -k > PowersOfTen.Most)
            {
                return false;
            }
            int h = power + PowersOfTen.BinaryExponent(-k) + 1;
            ulong cb = 4 * mantissa;
            ulong vb = RoundToOdd(-k, cb << h);
            ulong lower = RoundToOdd(-k, (cb - (isLowerCloser ? 1UL : 2UL)) << h);
            ulong upper = RoundToOdd(-k, (cb + 2) << h);
            if ((mantissa & 1) != 0) // the ends of the interval read back as an even neighbour
            {
                lower++;
                upper--;
            }
            ulong s = vb / 4;
            if (s >= 10)
            {
                ulong ten = s / 10;
                bool isTenInside = lower <= 40 * ten;
                bool isNextTenInside = 40 * ten + 40 <= upper;
                if (isTenInside != isNextTenInside)
                {
                    digits = isNextTenInside ? ten + 1 : ten;
                    k++;
                    return true;
                }
            }
            bool isInside = lower <= 4 * s;
            bool isNextInside = 4 * s + 4 <= upper;
            if (isInside != isNextInside)
            {
                digits = isNextInside ? s + 1 : s;
                return true;
            }
            ulong middle = 4 * s + 2;
            digits = vb > middle || (vb == middle && (s & 1) != 0) ? s + 1 : s;
            return true;
        }

        private static ulong RoundToOdd(int power, ulong factor)
        {
            ulong low;
            ulong lost;
            ulong carry = PowersOfTen.Multiply(PowersOfTen.Low(power), factor, out lost);
            ulong high = PowersOfTen.Multiply(PowersOfTen.High(power), factor, out low);
            low += carry;
            high += low < carry ? 1UL : 0UL;
            return high | (low > 1 ? 1UL : 0UL);
        }

        /// <summary>Tries one digit more at a time, until one of the two neighbours reads back.</summary>
        private static ulong OfRare(double value, ulong mantissa, int power, out int exponent)
        {
            byte[] all = new byte[DoubleDigits + 1];
            int first = ExactDecimal.Digits(mantissa, power, all);
            byte[] text = new byte[DoubleDigits + 8];
            ulong digits = 0;
            for (int i = 0; i < DoubleDigits; i++)
            {
                digits = digits * 10 + all[i];
                exponent = first - i;
                ulong nearer = all[i + 1] >= 5 ? 1UL : 0UL;
                if (ReadsBack(text, digits + nearer, exponent, value))
                {
                    digits += nearer;
                    return digits;
                }
                if (ReadsBack(text, digits + 1 - nearer, exponent, value))
                {
                    return digits + 1 - nearer;
                }
            }
            throw new InvalidOperationException("17 digits are enough for any double");
        }

        private static bool ReadsBack(byte[] text, ulong digits, int exponent, double value)
        {
            int end = DecimalText.WriteUInt64(text, 0, digits);
            text[end++] = (byte)'e';
            if (exponent < 0)
            {
                text[end++] = (byte)'-';
            }
            end = DecimalText.WriteUInt64(text, end, (ulong)Math.Abs(exponent));
            return ExactDecimal.Round(text, 0, end, ExactDecimal.DoubleFormat).Equals(value);
        }
    }
}
