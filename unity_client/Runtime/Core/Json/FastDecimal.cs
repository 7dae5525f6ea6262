// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway.Json
{
    /// <summary>
    /// The double nearest to a decimal number, by one multiplication or two. This is the algorithm of Eisel and
    /// Lemire (Lemire, Number Parsing at a Gigabyte per Second, 2021). It needs no fallback (Mushtak and
    /// Lemire, Fast Number Parsing Without Fallback, 2022) except for powers that the table lacks. Numbers of
    /// up to 15 digits, which most float32 are, need only a division (Clinger, How to Read Floating Point
    /// Numbers Accurately, 1990).
    /// </summary>
    internal static class FastDecimal
    {
        private const ulong LargestExact = 1UL << 53; // up to here every integer is a double

        /// <summary>The powers of ten that are doubles.</summary>
        private static readonly double[] ExactPowers =
        {
            1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11,
            1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
        };

        /// <summary>Rounds mantissa * 10^exponent, ties to even. False without such a power.</summary>
        internal static bool TryRound(ulong mantissa, long exponent, out double value)
        {
            value = 0;
            if (mantissa == 0)
            {
                return true;
            }
            if (exponent <= 0 && -exponent < ExactPowers.Length && mantissa <= LargestExact)
            {
                value = (long)mantissa / ExactPowers[-exponent]; // both are exact, so this rounds once
                return true;
            }
            if (exponent < PowersOfTen.Least || exponent > PowersOfTen.Most)
            {
                return false;
            }
            int power = (int)exponent;
            int shift = LeadingZeros(mantissa);
            ulong normalized = mantissa << shift;
            ulong low;
            ulong high = PowersOfTen.Multiply(normalized, PowersOfTen.High(power), out low);
            if ((high & 0x1FF) == 0x1FF) // the low half of the power could carry into the bits that count
            {
                ulong unused;
                ulong more = PowersOfTen.Multiply(normalized, PowersOfTen.Low(power), out unused);
                low += more;
                high += low < more ? 1UL : 0UL;
            }
            int upper = (int)(high >> 63);
            int dropped = upper + 64 - 52 - 3;
            ulong bits = high >> dropped;
            if (low <= 1 && power >= -4 && power <= 23 && (bits & 3) == 1 && bits << dropped == high)
            {
                bits &= ~1UL; // half way exactly, which only these powers allow
            }
            bits = (bits + (bits & 1)) >> 1;
            int biased = PowersOfTen.BinaryExponent(power) + 63 + upper - shift + 1023;
            if (bits >= 1UL << 53)
            {
                bits = 1UL << 52;
                biased++;
            }
            // No power of the table leads to a subnormal or to infinity.
            bits = (bits & ~(1UL << 52)) | ((ulong)biased << 52);
            value = BitConverter.Int64BitsToDouble((long)bits);
            return true;
        }

        private static int LeadingZeros(ulong value)
        {
            int count = 0;
            if (value >> 32 == 0)
            {
                count += 32;
                value <<= 32;
            }
            if (value >> 48 == 0)
            {
                count += 16;
                value <<= 16;
            }
            if (value >> 56 == 0)
            {
                count += 8;
                value <<= 8;
            }
            if (value >> 60 == 0)
            {
                count += 4;
                value <<= 4;
            }
            if (value >> 62 == 0)
            {
                count += 2;
                value <<= 2;
            }
            return value >> 63 == 0 ? count + 1 : count;
        }
    }
}
