// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway.Pictures
{
    /// <summary>A Huffman table of a JPEG (ISO/IEC 10918-1, annex C), made for decoding.</summary>
    internal sealed class HuffmanTable
    {
        internal const int LookupBits = 9; // nearly all codes of a picture are shorter
        internal const int MaxLength = 16;

        /// <summary>By the next bits: the code's length times 256 and its symbol. 0 where the code is longer.</summary>
        internal readonly ushort[] Lookup = new ushort[1 << LookupBits];

        /// <summary>By length: the first 16 bits that belong to a longer code.</summary>
        internal readonly int[] Limits = new int[MaxLength + 1];

        /// <summary>By length: what leads from a code to the index of its symbol.</summary>
        internal readonly int[] Offsets = new int[MaxLength + 1];

        /// <summary>In the order of their codes.</summary>
        internal readonly byte[] Symbols = new byte[256];

        /// <summary>Takes over a table as a DHT segment has it.</summary>
        /// <param name="at">The start of the 16 counts. The caller has made sure that they are there.</param>
        /// <param name="end">The end of the segment.</param>
        /// <returns>The end of the table.</returns>
        internal int Read(byte[] jpeg, int at, int end)
        {
            int counts = at - 1; // so that the count of a length is at the length
            at += MaxLength;
            Array.Clear(Lookup, 0, Lookup.Length);
            int code = 0;
            int known = 0;
            for (int length = 1; length <= MaxLength; length++)
            {
                int count = jpeg[counts + length];
                if (code + count > 1 << length || known + count > Symbols.Length)
                {
                    throw new JpegFormatException(
                        "a Huffman table has " + count + " codes of " + length + " bits, more than there is room for",
                        counts + length);
                }
                if (known + count > end - at)
                {
                    throw new JpegFormatException(
                        "a Huffman table of " + (known + count) + " symbols or more, its segment has " + (end - at),
                        counts + length);
                }
                Offsets[length] = known - code;
                for (int i = 0; i < count; i++, code++, known++)
                {
                    Symbols[known] = jpeg[at + known];
                    if (length <= LookupBits)
                    {
                        Fill(code, length, Symbols[known]);
                    }
                }
                Limits[length] = code << (MaxLength - length);
                code <<= 1;
            }
            return at + known;
        }

        private void Fill(int code, int length, byte symbol)
        {
            int first = code << (LookupBits - length);
            int beyond = (code + 1) << (LookupBits - length);
            for (int i = first; i < beyond; i++)
            {
                Lookup[i] = (ushort)((length << 8) | symbol);
            }
        }
    }
}
