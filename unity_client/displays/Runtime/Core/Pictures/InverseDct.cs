// SPDX-License-Identifier: Apache-2.0
namespace Ros2Gateway.Pictures
{
    /// <summary>Makes 8 x 8 samples of a block of coefficients.</summary>
    /// <remarks>
    /// The method of C. Loeffler, A. Ligtenberg and G. Moschytz ("Practical fast 1-D DCT algorithms with 11
    /// multiplications", ICASSP 1989), in integers with the word lengths of libjpeg's accurate method: so
    /// the samples are libjpeg's, to the last bit.
    /// </remarks>
    internal sealed class InverseDct
    {
        private const int Fraction = 13; // bits of the constants
        private const int Kept = 2; // bits that the first pass keeps beyond integers

        // cosines and their sums, times 2^13
        private const int C0298 = 2446;
        private const int C0390 = 3196;
        private const int C0541 = 4433;
        private const int C0765 = 6270;
        private const int C0899 = 7373;
        private const int C1175 = 9633;
        private const int C1501 = 12299;
        private const int C1847 = 15137;
        private const int C1961 = 16069;
        private const int C2053 = 16819;
        private const int C2562 = 20995;
        private const int C3072 = 25172;

        private readonly int[] _columns = new int[64];

        /// <summary>Writes the samples of a block that has its DC coefficient alone.</summary>
        internal static void WriteFlat(int dc, byte[] plane, int at, int stride)
        {
            byte sample = Sample(((dc << Kept) + (1 << (Kept + 2))) >> (Kept + 3));
            for (int row = 0; row < 8; row++, at += stride)
            {
                for (int i = 0; i < 8; i++)
                {
                    plane[at + i] = sample;
                }
            }
        }

        /// <summary>Writes the samples of a block.</summary>
        internal void Write(int[] block, byte[] plane, int at, int stride)
        {
            int[] columns = _columns;
            for (int i = 0; i < 8; i++)
            {
                TransformColumn(block, columns, i);
            }
            for (int i = 0; i < 64; i += 8, at += stride)
            {
                WriteRow(columns, i, plane, at);
            }
        }

        private static void TransformColumn(int[] block, int[] columns, int i)
        {
            int s1 = block[i + 8];
            int s2 = block[i + 16];
            int s3 = block[i + 24];
            int s4 = block[i + 32];
            int s5 = block[i + 40];
            int s6 = block[i + 48];
            int s7 = block[i + 56];
            if ((s1 | s2 | s3 | s4 | s5 | s6 | s7) == 0)
            {
                int dc = block[i] << Kept;
                columns[i] = dc;
                columns[i + 8] = dc;
                columns[i + 16] = dc;
                columns[i + 24] = dc;
                columns[i + 32] = dc;
                columns[i + 40] = dc;
                columns[i + 48] = dc;
                columns[i + 56] = dc;
                return;
            }
            int rotated = (s2 + s6) * C0541;
            int low = rotated - s6 * C1847;
            int high = rotated + s2 * C0765;
            int sum = (block[i] + s4) << Fraction;
            int difference = (block[i] - s4) << Fraction;
            int even0 = sum + high;
            int even3 = sum - high;
            int even1 = difference + low;
            int even2 = difference - low;

            int z5 = (s7 + s3 + s5 + s1) * C1175;
            int z1 = (s7 + s1) * -C0899;
            int z2 = (s5 + s3) * -C2562;
            int z3 = (s7 + s3) * -C1961 + z5;
            int z4 = (s5 + s1) * -C0390 + z5;
            int odd0 = s7 * C0298 + z1 + z3;
            int odd1 = s5 * C2053 + z2 + z4;
            int odd2 = s3 * C3072 + z2 + z3;
            int odd3 = s1 * C1501 + z1 + z4;

            const int Shift = Fraction - Kept;
            const int Half = 1 << (Shift - 1);
            columns[i] = (even0 + odd3 + Half) >> Shift;
            columns[i + 56] = (even0 - odd3 + Half) >> Shift;
            columns[i + 8] = (even1 + odd2 + Half) >> Shift;
            columns[i + 48] = (even1 - odd2 + Half) >> Shift;
            columns[i + 16] = (even2 + odd1 + Half) >> Shift;
            columns[i + 40] = (even2 - odd1 + Half) >> Shift;
            columns[i + 24] = (even3 + odd0 + Half) >> Shift;
            columns[i + 32] = (even3 - odd0 + Half) >> Shift;
        }

        private static void WriteRow(int[] columns, int i, byte[] plane, int at)
        {
            int s0 = columns[i];
            int s1 = columns[i + 1];
            int s2 = columns[i + 2];
            int s3 = columns[i + 3];
            int s4 = columns[i + 4];
            int s5 = columns[i + 5];
            int s6 = columns[i + 6];
            int s7 = columns[i + 7];
            int rotated = (s2 + s6) * C0541;
            int low = rotated - s6 * C1847;
            int high = rotated + s2 * C0765;
            int sum = (s0 + s4) << Fraction;
            int difference = (s0 - s4) << Fraction;
            const int Shift = Fraction + Kept + 3;
            const int Half = 1 << (Shift - 1);
            int even0 = sum + high + Half;
            int even3 = sum - high + Half;
            int even1 = difference + low + Half;
            int even2 = difference - low + Half;

            int z5 = (s7 + s3 + s5 + s1) * C1175;
            int z1 = (s7 + s1) * -C0899;
            int z2 = (s5 + s3) * -C2562;
            int z3 = (s7 + s3) * -C1961 + z5;
            int z4 = (s5 + s1) * -C0390 + z5;
            int odd0 = s7 * C0298 + z1 + z3;
            int odd1 = s5 * C2053 + z2 + z4;
            int odd2 = s3 * C3072 + z2 + z3;
            int odd3 = s1 * C1501 + z1 + z4;

            plane[at + 7] = Sample((even0 - odd3) >> Shift);
            plane[at] = Sample((even0 + odd3) >> Shift);
            plane[at + 1] = Sample((even1 + odd2) >> Shift);
            plane[at + 6] = Sample((even1 - odd2) >> Shift);
            plane[at + 2] = Sample((even2 + odd1) >> Shift);
            plane[at + 5] = Sample((even2 - odd1) >> Shift);
            plane[at + 3] = Sample((even3 + odd0) >> Shift);
            plane[at + 4] = Sample((even3 - odd0) >> Shift);
        }

        // Coefficients stand for differences from the middle of the range (A.3.1).
        private static byte Sample(int value)
        {
            int sample = value + 128;
            if ((sample & ~255) == 0)
            {
                return (byte)sample;
            }
            return sample < 0 ? (byte)0 : (byte)255;
        }
    }
}
