// SPDX-License-Identifier: Apache-2.0
namespace Ros2Gateway.Pictures
{
    /// <summary>Reads the entropy-coded blocks of a scan (ISO/IEC 10918-1, annex F.2.2).</summary>
    internal sealed class EntropyReader
    {
        private const int CoefficientBits = 32; // one takes 31 at most: a code of 16 and a value of 15
        private const int FullBits = 48; // with one byte more, the buffer's 64 bits are not exceeded
        private const int MaxDcBits = 11; // of 8 bits per sample (table F.1)
        private const int FirstRestart = 0xD0;

        private byte[] _jpeg;
        private int _at;
        private int _end;
        private ulong _bits; // the lowest are the next ones
        private int _count; // how many of them
        private int _invented; // of these, the last: zeros where the data have ended

        /// <summary>Begins with a scan, whose data begin there.</summary>
        internal void Begin(byte[] jpeg, int at, int end)
        {
            _jpeg = jpeg;
            _at = at;
            _end = end;
            Forget();
        }

        /// <summary>
        /// Reads a block into *block*, which must be zeros: coefficients times their steps, in the order of rows.
        /// </summary>
        /// <param name="steps">The quantization table, in zigzag order.</param>
        /// <param name="prediction">The DC coefficient of the block before.</param>
        /// <returns>Whether there is more than the DC coefficient.</returns>
        internal bool ReadBlock(HuffmanTable dc, HuffmanTable ac, int[] steps, ref int prediction, int[] block)
        {
            if (_count < CoefficientBits)
            {
                Fill();
            }
            int size = ReadSymbol(dc);
            if (size > MaxDcBits)
            {
                throw new JpegFormatException("a brightness of " + size + " bits, at most " + MaxDcBits, _at);
            }
            if (size > 0)
            {
                _count -= size;
                prediction += Signed((int)(_bits >> _count) & ((1 << size) - 1), size);
            }
            block[0] = prediction * steps[0];
            bool isFlat = ReadRest(ac, steps, block);
            if (_invented > _count)
            {
                throw new JpegFormatException("the data end within the picture", _at);
            }
            return !isFlat;
        }

        /// <summary>Goes on behind a restart marker.</summary>
        /// <param name="number">Its number, 0 to 7.</param>
        internal void Restart(int number)
        {
            int marker = End();
            if (marker >= _end || _jpeg[marker] != FirstRestart + number)
            {
                throw new JpegFormatException(
                    "expected restart marker " + number + ", found " + Found(marker), marker);
            }
            _at = marker + 1;
            Forget();
        }

        /// <summary>Ends the scan, or a part of it.</summary>
        /// <returns>The place of the next marker's code, or the end of the data.</returns>
        internal int End()
        {
            int left = _count - _invented;
            if (left >= 8)
            {
                throw new JpegFormatException(left / 8 + " bytes of data or more belong to no block", _at);
            }
            // the unread bytes begin with the marker, if all bytes of the blocks were read
            int at = _at;
            if (at < _end && _jpeg[at] != 0xFF)
            {
                throw new JpegFormatException("data that belong to no block", at);
            }
            while (at < _end && _jpeg[at] == 0xFF)
            {
                at++;
            }
            if (at < _end && _jpeg[at] == 0)
            {
                throw new JpegFormatException("data that belong to no block", at);
            }
            return at;
        }

        /// <summary>Reads all but the DC coefficient. True if all are 0.</summary>
        private bool ReadRest(HuffmanTable table, int[] steps, int[] block)
        {
            byte[] order = Zigzag.Order;
            ushort[] lookup = table.Lookup;
            ulong bits = _bits;
            int count = _count;
            bool isFlat = true;
            for (int k = 1; k < 64; k++)
            {
                if (count < CoefficientBits)
                {
                    _count = count;
                    Fill();
                    bits = _bits;
                    count = _count;
                }
                int symbol = lookup[(int)(bits >> (count - HuffmanTable.LookupBits))
                    & ((1 << HuffmanTable.LookupBits) - 1)];
                if (symbol != 0)
                {
                    count -= symbol >> 8;
                    symbol &= 255;
                }
                else
                {
                    _count = count;
                    symbol = ReadLongSymbol(table);
                    count = _count;
                }
                int size = symbol & 15;
                if (size == 0)
                {
                    if (symbol != 0xF0)
                    {
                        break; // the end of the block
                    }
                    k += 15; // sixteen zeros
                    continue;
                }
                k += symbol >> 4;
                if (k > 63)
                {
                    throw new JpegFormatException("a block of more than 64 coefficients", _at);
                }
                count -= size;
                int value = Signed((int)(bits >> count) & ((1 << size) - 1), size);
                block[order[k]] = value * steps[k];
                isFlat = false;
            }
            _count = count;
            return isFlat;
        }

        private int ReadSymbol(HuffmanTable table)
        {
            int entry = table.Lookup[(int)(_bits >> (_count - HuffmanTable.LookupBits))
                & ((1 << HuffmanTable.LookupBits) - 1)];
            if (entry == 0)
            {
                return ReadLongSymbol(table);
            }
            _count -= entry >> 8;
            return entry & 255;
        }

        private int ReadLongSymbol(HuffmanTable table)
        {
            int next = (int)(_bits >> (_count - HuffmanTable.MaxLength)) & 0xFFFF;
            for (int length = HuffmanTable.LookupBits + 1; length <= HuffmanTable.MaxLength; length++)
            {
                if (next < table.Limits[length])
                {
                    _count -= length;
                    return table.Symbols[table.Offsets[length] + (next >> (HuffmanTable.MaxLength - length))];
                }
            }
            throw new JpegFormatException("a code that its Huffman table does not have", _at);
        }

        // Zeros follow where the data end, at a marker mostly: a code may be looked up beyond the last one.
        // Whether they were needed shows when the block is read.
        private void Fill()
        {
            byte[] jpeg = _jpeg;
            ulong bits = _bits;
            int count = _count;
            int at = _at;
            int end = _end;
            while (count <= FullBits)
            {
                int next = at < end ? jpeg[at] : 0xFF;
                if (next != 0xFF)
                {
                    at++;
                }
                else if (at + 1 < end && jpeg[at + 1] == 0)
                {
                    at += 2; // a byte of ones has a zero byte behind it, or it would look like a marker
                }
                else
                {
                    next = 0;
                    _invented += 8;
                }
                bits = (bits << 8) | (uint)next;
                count += 8;
            }
            _bits = bits;
            _count = count;
            _at = at;
        }

        private void Forget()
        {
            _bits = 0;
            _count = 0;
            _invented = 0;
        }

        private string Found(int marker) => marker < _end ? "marker " + _jpeg[marker].ToString("X2") : "the end";

        // Table F.1: the lower half of a size's values stands for the negative ones.
        private static int Signed(int value, int size) => value < 1 << (size - 1) ? value - (1 << size) + 1 : value;
    }
}
