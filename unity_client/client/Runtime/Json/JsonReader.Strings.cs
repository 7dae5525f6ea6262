// SPDX-License-Identifier: Apache-2.0
using System;
using System.Buffers.Text;
using System.Text;

namespace Ros2Gateway.Json
{
    public partial class JsonReader
    {
        /// <summary>The longest text that may be the same object as an equal one before.</summary>
        private protected const int LongestCached = 32; // bytes: frames, topics and operations, not texts
        private const int CacheSlots = 256; // a power of two. A slot keeps the last string that hashed to it
        private const int LargestScratch = 1 << 16; // chars: one huge text must not be paid forever after

        // The letters after a backslash, and the characters they stand for.
        internal const string EscapeLetters = "\"\\/bfnrt";
        internal const string EscapedCharacters = "\"\\/\b\f\n\r\t";

        private protected static readonly Encoding StrictUtf8 = new UTF8Encoding(false, true);

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
                return DecodeString();
            }
            int length = _position++ - start;
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
            bool isKnown = known != null && known.Length == length;
            for (int i = 0; isKnown && i < length; i++)
            {
                isKnown = known[i] == _buffer[start + i];
            }
            return isKnown ? known : _cache[slot] = PlainString(start, length);
        }

        private string PlainString(int start, int length)
        {
            char[] scratch = Scratch(length);
            for (int i = 0; i < length; i++)
            {
                scratch[i] = (char)_buffer[start + i];
            }
            return new string(scratch, 0, length);
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

        /// <summary>Reads a text with anything in it, from behind the opening to behind the closing quote.
        /// </summary>
        private string DecodeString()
        {
            int start = _position;
            // No text has more chars than bytes, so the scratch is large enough once the end is known.
            char[] scratch = Scratch(ClosingQuote() - start);
            try
            {
                int count = DecodeString(scratch);
                StrictUtf8.GetByteCount(scratch, 0, count); // refuses half of a surrogate pair, from an escape
                return new string(scratch, 0, count);
            }
            catch (ArgumentException)
            {
                _position = start;
                throw Error("a string is not UTF-8, or has half of a surrogate pair");
            }
        }

        private int DecodeString(char[] scratch)
        {
            int count = 0;
            while (true)
            {
                int start = _position;
                byte next = _buffer[start];
                while (next >= 0x20 && next != (byte)'"' && next != (byte)'\\')
                {
                    next = _buffer[++_position];
                }
                count += StrictUtf8.GetChars(_buffer, start, _position - start, scratch, count);
                if (next == (byte)'"')
                {
                    _position++;
                    return count;
                }
                scratch[count++] = next == (byte)'\\' ? Unescaped()
                    : throw Error("expected no control character in a string, got the byte " + next);
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

        private char Unescaped()
        {
            char escaped = (char)_buffer[_position + 1];
            int known = EscapeLetters.IndexOf(escaped);
            if (known >= 0)
            {
                _position += 2;
                return EscapedCharacters[known];
            }
            if (escaped != 'u')
            {
                throw Error("a string has an escape that JSON does not know");
            }
            ReadOnlySpan<byte> digits = new(_buffer, _position + 2, Math.Min(4, _end - _position - 2));
            if (!Utf8Parser.TryParse(digits, out ushort unit, out int count, 'x') || count < 4)
            {
                throw Error("a string has \\u without four hexadecimal digits");
            }
            _position += 6;
            return (char)unit;
        }
    }
}
