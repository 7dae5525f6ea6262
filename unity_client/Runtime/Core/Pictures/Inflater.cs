// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway.Pictures
{
    /// <summary>
    /// Decompresses a zlib stream (RFC 1950, 1951) into a buffer of known size. Managed, as Unity's own goes through a
    /// native library that not every platform has.
    /// </summary>
    internal sealed class Inflater
    {
        private const int MaxBits = 15;
        private const int FastBits = 10; // most codes of a picture are shorter: one look finds them
        private const int EndOfBlock = 256;

        private static readonly byte[] LengthOrder = { 16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15 };
        private static readonly ushort[] LengthBase =
        {
            3, 4, 5, 6, 7, 8, 9, 10, 11, 13, 15, 17, 19, 23, 27, 31, 35, 43, 51, 59, 67, 83, 99, 115, 131, 163, 195, 227,
            258,
        };

        private static readonly byte[] LengthExtra =
        {
            0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0,
        };

        private static readonly ushort[] DistanceBase =
        {
            1, 2, 3, 4, 5, 7, 9, 13, 17, 25, 33, 49, 65, 97, 129, 193, 257, 385, 513, 769, 1025, 1537, 2049, 3073, 4097,
            6145, 8193, 12289, 16385, 24577,
        };

        private readonly Code _literals = new Code(288);
        private readonly Code _distances = new Code(32);
        private readonly byte[] _lengths = new byte[288 + 32];
        private byte[] _input;
        private int _at;
        private int _end;
        private uint _bits;
        private int _bitCount;
        private byte[] _output;
        private int _written;

        /// <summary>Fills *output* up to *count* bytes.</summary>
        /// <exception cref="FormatException">The stream is damaged, or holds fewer or more bytes.</exception>
        internal void Inflate(byte[] input, int start, int end, byte[] output, int count)
        {
            _input = input;
            _at = start;
            _end = end;
            _bits = 0;
            _bitCount = 0;
            _output = output;
            _written = 0;
            uint method = Bits(8), flags = Bits(8);
            if ((method & 15) != 8 || (method * 256 + flags) % 31 != 0 || (flags & 32) != 0)
            {
                throw new FormatException("not a zlib stream");
            }
            bool isLast = false;
            while (!isLast)
            {
                isLast = Bits(1) == 1;
                Block(Bits(2), count);
            }
            if (_written != count)
            {
                throw new FormatException("the stream has " + _written + " bytes, must have " + count);
            }
        }

        private void Block(uint kind, int count)
        {
            switch (kind)
            {
                case 0:
                    Stored(count);
                    break;
                case 1:
                    FixedCodes();
                    Compressed(count);
                    break;
                case 2:
                    DynamicCodes();
                    Compressed(count);
                    break;
                default:
                    throw new FormatException("a block of unknown kind");
            }
        }

        private void Stored(int count)
        {
            _bits >>= _bitCount & 7;
            _bitCount -= _bitCount & 7;
            int length = (int)Bits(16);
            Bits(16); // the complement
            if (length > count - _written)
            {
                throw TooLong(count);
            }
            for (int i = 0; i < length; i++)
            {
                _output[_written++] = (byte)Bits(8);
            }
        }

        private void FixedCodes()
        {
            for (int i = 0; i < 288; i++)
            {
                _lengths[i] = (byte)(i < 144 ? 8 : i < 256 ? 9 : i < 280 ? 7 : 8);
            }
            _literals.Set(_lengths, 0, 288);
            for (int i = 0; i < 30; i++)
            {
                _lengths[i] = 5;
            }
            _distances.Set(_lengths, 0, 30);
        }

        private void DynamicCodes()
        {
            int literals = (int)Bits(5) + 257, distances = (int)Bits(5) + 1, lengths = (int)Bits(4) + 4;
            Array.Clear(_lengths, 0, LengthOrder.Length);
            for (int i = 0; i < lengths; i++)
            {
                _lengths[LengthOrder[i]] = (byte)Bits(3);
            }
            _literals.Set(_lengths, 0, LengthOrder.Length);
            int at = 0;
            while (at < literals + distances)
            {
                int symbol = Symbol(_literals);
                if (symbol < 16)
                {
                    _lengths[at++] = (byte)symbol;
                    continue;
                }
                if (symbol == 16 && at == 0)
                {
                    throw new FormatException("a length repeats nothing");
                }
                byte repeated = symbol == 16 ? _lengths[at - 1] : (byte)0;
                int times = (int)(symbol == 16 ? 3 + Bits(2) : symbol == 17 ? 3 + Bits(3) : 11 + Bits(7));
                if (at + times > literals + distances)
                {
                    throw new FormatException("too many lengths");
                }
                for (; times > 0; times--)
                {
                    _lengths[at++] = repeated;
                }
            }
            _literals.Set(_lengths, 0, literals);
            _distances.Set(_lengths, literals, distances);
        }

        private void Compressed(int count)
        {
            while (true)
            {
                int symbol = Symbol(_literals);
                if (symbol < EndOfBlock)
                {
                    if (_written >= count)
                    {
                        throw TooLong(count);
                    }
                    _output[_written++] = (byte)symbol;
                }
                else if (symbol == EndOfBlock)
                {
                    return;
                }
                else
                {
                    Copy(symbol - 257, count);
                }
            }
        }

        private void Copy(int symbol, int count)
        {
            if (symbol >= LengthBase.Length)
            {
                throw new FormatException("an unknown length");
            }
            int length = LengthBase[symbol] + (int)Bits(LengthExtra[symbol]);
            int code = Symbol(_distances);
            if (code >= DistanceBase.Length)
            {
                throw new FormatException("an unknown distance");
            }
            int distance = DistanceBase[code] + (int)Bits(code < 4 ? 0 : code / 2 - 1);
            if (distance > _written)
            {
                throw new FormatException("a distance from before the beginning");
            }
            if (length > count - _written)
            {
                throw TooLong(count);
            }
            byte[] output = _output;
            int at = _written, from = at - distance; // they may overlap: byte by byte
            for (int i = 0; i < length; i++)
            {
                output[at + i] = output[from + i];
            }
            _written = at + length;
        }

        private int Symbol(Code code)
        {
            Fill();
            int entry = code.Fast[_bits & ((1 << FastBits) - 1)];
            if (entry != 0)
            {
                Drop(entry & 15);
                return entry >> 4;
            }
            return code.Slow(this);
        }

        private uint Bits(int count)
        {
            if (_bitCount < count)
            {
                Fill();
            }
            uint value = _bits & ((1u << count) - 1);
            Drop(count);
            return value;
        }

        private void Fill()
        {
            while (_bitCount <= 24 && _at < _end)
            {
                _bits |= (uint)_input[_at++] << _bitCount;
                _bitCount += 8;
            }
        }

        private void Drop(int count)
        {
            if (count > _bitCount)
            {
                throw new FormatException("the stream ends too early");
            }
            _bits >>= count;
            _bitCount -= count;
        }

        private static FormatException TooLong(int count)
        {
            return new FormatException("the stream has more than " + count + " bytes");
        }

        /// <summary>A Huffman code: a table for short codes, the canonical numbering for the others.</summary>
        private sealed class Code
        {
            /// <summary>Symbol and length by the next bits. 0 where the code is longer, or none.</summary>
            internal readonly int[] Fast = new int[1 << FastBits];

            private readonly int[] _counts = new int[MaxBits + 1];
            private readonly int[] _symbols;
            private readonly int[] _next = new int[MaxBits + 2];
            private readonly int[] _offsets = new int[MaxBits + 2];

            internal Code(int symbols)
            {
                _symbols = new int[symbols];
            }

            internal void Set(byte[] lengths, int start, int count)
            {
                Array.Clear(_counts, 0, _counts.Length);
                Array.Clear(Fast, 0, Fast.Length);
                for (int i = 0; i < count; i++)
                {
                    _counts[lengths[start + i]]++;
                }
                _counts[0] = 0;
                int code = 0, offset = 0, left = 1;
                for (int length = 1; length <= MaxBits; length++)
                {
                    code = code + _counts[length - 1] << 1;
                    _next[length] = code;
                    _offsets[length] = offset;
                    offset += _counts[length];
                    left = (left << 1) - _counts[length];
                    if (left < 0)
                    {
                        throw new FormatException("codes that are ambiguous");
                    }
                }
                for (int symbol = 0; symbol < count; symbol++)
                {
                    int length = lengths[start + symbol];
                    if (length > 0)
                    {
                        _symbols[_offsets[length]++] = symbol;
                        Learn(symbol, length, _next[length]++);
                    }
                }
            }

            internal int Slow(Inflater from)
            {
                int code = 0, first = 0, index = 0;
                for (int length = 1; length <= MaxBits; length++)
                {
                    code |= (int)from.Bits(1);
                    int count = _counts[length];
                    if (code - first < count)
                    {
                        return _symbols[index + code - first];
                    }
                    index += count;
                    first = first + count << 1;
                    code <<= 1;
                }
                throw new FormatException("an unknown code");
            }

            // The stream has a code's first bit lowest, and anything may follow it.
            private void Learn(int symbol, int length, int code)
            {
                if (length > FastBits)
                {
                    return;
                }
                int reversed = 0;
                for (int bit = 0; bit < length; bit++)
                {
                    reversed |= (code >> bit & 1) << (length - 1 - bit);
                }
                for (int at = reversed; at < Fast.Length; at += 1 << length)
                {
                    Fast[at] = symbol << 4 | length;
                }
            }
        }
    }
}
