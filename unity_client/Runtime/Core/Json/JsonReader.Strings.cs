// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway.Json
{
    public partial class JsonReader
    {
        /// <summary>The longest text that may be the same object as an equal one before.</summary>
        private protected const int LongestCached = 32; // bytes: frames, topics and operations, not texts
        private const int CacheSlots = 256; // a power of two. A slot keeps the last string that hashed to it
        private const int LargestScratch = 1 << 16; // chars: one huge text must not be paid forever after

        private readonly string[] _cache = new string[CacheSlots];
        private char[] _scratch = new char[64];

        /// <summary>
        /// Reads a text. One of up to 32 bytes of ASCII is mostly the same object as the last of that text.
        /// </summary>
        public virtual string ReadString()
        {
            SkipSpace();
            if (_position >= _end || _buffer[_position] != (byte)'"')
            {
                throw Unexpected("a string");
            }
            _position++;
            return StringAfterQuote();
        }

        private string StringAfterQuote()
        {
            int start = _position;
            if (!ScanPlain())
            {
                _position = start;
                return DecodeString();
            }
            int length = _position - start;
            _position++;
            if (length == 0)
            {
                return "";
            }
            return length <= LongestCached ? Cached(start, length) : PlainString(start, length);
        }

        /// <summary>Goes to the closing quote if nothing but printable ASCII without escapes is before it.
        /// </summary>
        private bool ScanPlain()
        {
            byte[] buffer = _buffer;
            int end = _end;
            for (int i = _position; i < end; i++)
            {
                byte next = buffer[i];
                if (next == (byte)'"')
                {
                    _position = i;
                    return true;
                }
                if (next < 0x20 || next >= 0x80 || next == (byte)'\\')
                {
                    return false;
                }
            }
            return false;
        }

        /// <summary>A short text of ASCII.</summary>
        private protected string Cached(int start, int length)
        {
            uint hash = 2166136261; // FNV-1a
            for (int i = 0; i < length; i++)
            {
                hash = (hash ^ _buffer[start + i]) * 16777619;
            }
            uint slot = (hash ^ (hash >> 16)) % CacheSlots;
            string known = _cache[slot];
            if (known != null && known.Length == length && IsAt(known, start))
            {
                return known;
            }
            string made = PlainString(start, length);
            _cache[slot] = made;
            return made;
        }

        private bool IsAt(string known, int start)
        {
            for (int i = 0; i < known.Length; i++)
            {
                if (known[i] != _buffer[start + i])
                {
                    return false;
                }
            }
            return true;
        }

        private string PlainString(int start, int length)
        {
            char[] scratch = Scratch(length);
            for (int i = 0; i < length; i++)
            {
                scratch[i] = (char)_buffer[start + i];
            }
            return Made(scratch, length);
        }

        private char[] Scratch(int length)
        {
            if (length <= _scratch.Length)
            {
                return _scratch;
            }
            char[] larger = new char[Math.Max(length, Math.Min(2 * _scratch.Length, LargestScratch))];
            if (larger.Length <= LargestScratch)
            {
                _scratch = larger;
            }
            return larger;
        }

        private static string Made(char[] scratch, int length)
        {
            return new string(scratch, 0, length);
        }

        /// <summary>Reads a text with anything in it, from behind the opening to behind the closing quote.
        /// </summary>
        private string DecodeString()
        {
            // No text has more chars than bytes, so the scratch is large enough once the end is known.
            char[] scratch = Scratch(ClosingQuote() - _position);
            int count = 0;
            while (true)
            {
                byte next = _position < _end ? _buffer[_position] : (byte)0;
                if (next == (byte)'"')
                {
                    _position++;
                    return Made(scratch, count);
                }
                if (next < 0x20)
                {
                    throw Error("expected no control character in a string, got " + DescribeNext());
                }
                if (next == (byte)'\\')
                {
                    count = DecodeEscape(scratch, count);
                }
                else if (next < 0x80)
                {
                    scratch[count++] = (char)next;
                    _position++;
                }
                else
                {
                    count = DecodeUtf8(scratch, count);
                }
            }
        }

        private int ClosingQuote()
        {
            byte[] buffer = _buffer;
            int end = _end;
            for (int i = _position; i < end; i++)
            {
                byte next = buffer[i];
                if (next == (byte)'"')
                {
                    return i;
                }
                if (next == (byte)'\\')
                {
                    i++;
                }
            }
            _position = _end;
            throw Error("expected the quote that ends a string, got the end");
        }

        private int DecodeEscape(char[] scratch, int count)
        {
            byte escaped = _position + 1 < _end ? _buffer[_position + 1] : (byte)0;
            if (escaped == (byte)'u')
            {
                return DecodeUnicodeEscape(scratch, count);
            }
            scratch[count] = Unescaped(escaped);
            _position += 2;
            return count + 1;
        }

        private char Unescaped(byte escaped)
        {
            switch (escaped)
            {
                case (byte)'"':
                case (byte)'\\':
                case (byte)'/':
                    return (char)escaped;
                case (byte)'b':
                    return '\b';
                case (byte)'f':
                    return '\f';
                case (byte)'n':
                    return '\n';
                case (byte)'r':
                    return '\r';
                case (byte)'t':
                    return '\t';
                default:
                    throw Error("a string has an escape that JSON does not know");
            }
        }

        private int DecodeUnicodeEscape(char[] scratch, int count)
        {
            int unit = HexUnit(_position);
            bool isLow = unit >= 0xDC00 && unit < 0xE000;
            if (isLow)
            {
                throw Error("a string has the second half of a surrogate pair alone");
            }
            scratch[count++] = (char)unit;
            _position += 6;
            if (unit < 0xD800 || unit >= 0xE000)
            {
                return count;
            }
            bool hasSecond = _position + 1 < _end
                && _buffer[_position] == (byte)'\\' && _buffer[_position + 1] == (byte)'u';
            int second = hasSecond ? HexUnit(_position) : 0;
            if (second < 0xDC00 || second >= 0xE000)
            {
                throw Error("a string has the first half of a surrogate pair alone");
            }
            scratch[count++] = (char)second;
            _position += 6;
            return count;
        }

        private int HexUnit(int backslash)
        {
            int value = 0;
            for (int i = backslash + 2; i < backslash + 6; i++)
            {
                int digit = i < _end ? HexDigit(_buffer[i]) : -1;
                if (digit < 0)
                {
                    throw Error("a string has \\u without four hexadecimal digits");
                }
                value = (value << 4) | digit;
            }
            return value;
        }

        private static int HexDigit(byte value)
        {
            if (IsDigit(value))
            {
                return value - '0';
            }
            int letter = (value | 0x20) - 'a';
            return letter >= 0 && letter < 6 ? letter + 10 : -1;
        }

        /// <summary>Decodes one code point beyond ASCII (RFC 3629: no overlong form, no surrogate).</summary>
        private int DecodeUtf8(char[] scratch, int count)
        {
            byte first = _buffer[_position];
            int length = first < 0xC2 ? 0 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : first < 0xF5 ? 4 : 0;
            bool isValid = length > 0 && _position + length <= _end;
            int point = first & (0xFF >> (length + 1));
            for (int i = 1; isValid && i < length; i++)
            {
                byte next = _buffer[_position + i];
                isValid = (next & 0xC0) == 0x80;
                point = (point << 6) | (next & 0x3F);
            }
            isValid = isValid && (length < 3 || point >= (length == 3 ? 0x800 : 0x10000))
                && (point < 0xD800 || point >= 0xE000) && point <= 0x10FFFF;
            if (!isValid)
            {
                throw Error("a string is not UTF-8");
            }
            _position += length;
            if (point < 0x10000)
            {
                scratch[count] = (char)point;
                return count + 1;
            }
            scratch[count] = (char)(0xD7C0 + (point >> 10));
            scratch[count + 1] = (char)(0xDC00 | (point & 0x3FF));
            return count + 2;
        }
    }
}
