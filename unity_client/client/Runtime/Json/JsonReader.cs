// SPDX-License-Identifier: Apache-2.0
using System;
using System.Text;

namespace Ros2Gateway.Json
{
    /// <summary>
    /// Reads JSON (RFC 8259, nothing beyond it) from UTF-8, value by value, in the order of the text. It
    /// allocates nothing but what it returns. One thread at a time. Use it again by <see cref="Reset"/>,
    /// which it also needs after a <see cref="JsonFormatException"/>. Of two members of one name the last
    /// wins.
    /// </summary>
    /// <remarks>
    /// A client's subscriptions may get the same values as CBOR. Their reader is of this class as well, so
    /// messages do not notice.
    /// </remarks>
    public partial class JsonReader
    {
        /// <summary>Objects and arrays that were entered, up to <see cref="_depth"/>.</summary>
        private protected readonly Level[] _levels;

        /// <summary>How many were entered.</summary>
        private protected int _depth;

        /// <summary>The bytes to read, from <see cref="_position"/> to before <see cref="_end"/>.</summary>
        private protected byte[] _buffer = Array.Empty<byte>();

        /// <summary>The place of the next byte.</summary>
        private protected int _position;

        /// <summary>The end of the bytes to read.</summary>
        private protected int _end;

        /// <summary>Makes a reader of nothing. Objects and arrays may nest up to a depth.</summary>
        public JsonReader(int maxDepth = 64) => _levels = new Level[maxDepth + 1];

        /// <summary>The place of the next byte, from the start of the buffer.</summary>
        public int Position => _position;

        /// <summary>The kind of the value that comes next. Nothing is consumed but white space.</summary>
        /// <exception cref="JsonFormatException">The next bytes do not begin a value.</exception>
        public JsonKind Kind => Next() ?? throw Unexpected("a value");

        /// <summary>The kind of the value that comes next. Null for bytes that do not begin one.</summary>
        private protected virtual JsonKind? Next()
        {
            SkipSpace();
            if (_position >= _end)
            {
                return JsonKind.End;
            }
            return _buffer[_position] switch
            {
                (byte)'{' => JsonKind.Object,
                (byte)'[' => JsonKind.Array,
                (byte)'"' => JsonKind.String,
                (byte)'-' or (>= (byte)'0' and <= (byte)'9') => JsonKind.Number,
                (byte)'t' when IsLiteralNext("true") => JsonKind.Boolean,
                (byte)'f' when IsLiteralNext("false") => JsonKind.Boolean,
                (byte)'n' when IsLiteralNext("null") => JsonKind.Null,
                _ => null,
            };
        }

        /// <summary>Starts again with a part of a buffer, which must not change while it is read.</summary>
        public void Reset(byte[] buffer, int offset, int count)
        {
            _ = new ReadOnlySpan<byte>(buffer, offset, count); // refuses what is not there
            _buffer = buffer;
            _position = offset;
            _end = offset + count;
            _depth = 0;
        }

        /// <summary>Enters the object that comes next.</summary>
        public virtual void BeginObject() => Enter((byte)'{', "an object", false);

        /// <summary>
        /// Goes to the next member of the object that was entered, or leaves it. The member's value must be
        /// read or skipped before the next call.
        /// </summary>
        /// <param name="members">The names that are known.</param>
        /// <param name="member">Start with <see cref="JsonMembers.Unknown"/>. Becomes the index of the name.
        /// The one after the last is tried first, because fields mostly come in order.</param>
        /// <returns>False when the object has ended.</returns>
        public virtual bool NextMember(JsonMembers members, ref int member)
        {
            if (!NextQuote())
            {
                return false;
            }
            int start = _position;
            int length = members.LengthIfNext(member + 1, _buffer, start, _end);
            if (length >= 0)
            {
                member++;
                _position = start + length + 1;
            }
            else if (ScanPlain())
            {
                length = _position - start;
                member = members.IndexOf(_buffer, start, length);
                _position++;
            }
            else
            {
                _position = start;
                byte[] name = Encoding.UTF8.GetBytes(DecodeString());
                member = members.IndexOf(name, 0, name.Length);
                length = _position - 1 - start;
            }
            AfterName(start, length);
            return true;
        }

        /// <summary>Goes to the next member of the object that was entered.</summary>
        /// <returns>Its name, null when the object has ended.</returns>
        public virtual string NextName()
        {
            if (!NextQuote())
            {
                return null;
            }
            int start = _position;
            string name = StringAfterQuote();
            AfterName(start, _position - 1 - start);
            return name;
        }

        /// <summary>Enters the array that comes next.</summary>
        public virtual void BeginArray() => Enter((byte)'[', "an array", true);

        /// <summary>
        /// Goes to the next element of the array that was entered, or leaves it. The element must be read or
        /// skipped before the next call.
        /// </summary>
        /// <returns>False when the array has ended.</returns>
        public virtual bool NextElement()
        {
            SkipSpace();
            int index = _levels[_depth].Index + 1;
            byte next = _position < _end ? _buffer[_position] : (byte)0;
            if (next == (byte)']')
            {
                _position++;
                _depth--;
                return false;
            }
            if (index > 0)
            {
                if (next != (byte)',')
                {
                    throw Unexpected("a comma or the end of the array");
                }
                _position++;
            }
            _levels[_depth].Index = index;
            return true;
        }

        /// <summary>Reads true or false.</summary>
        public virtual bool ReadBool()
        {
            SkipSpace();
            return TakeLiteral("true") || (TakeLiteral("false") ? false : throw Unexpected("true or false"));
        }

        /// <summary>Consumes a null, if one comes next.</summary>
        public virtual bool TryReadNull()
        {
            SkipSpace();
            return TakeLiteral("null");
        }

        /// <summary>Makes sure that only white space is left.</summary>
        public virtual void End()
        {
            SkipSpace();
            if (_position < _end)
            {
                throw Unexpected("the end");
            }
        }

        private static bool IsDigit(byte value) => (uint)(value - '0') <= 9;

        private void SkipSpace()
        {
            while (_position < _end)
            {
                byte next = _buffer[_position];
                if (next > 0x20 || (next != 0x20 && next != 0x0A && next != 0x0D && next != 0x09))
                {
                    return;
                }
                _position++;
            }
        }

        private void Enter(byte bracket, string expected, bool isArray)
        {
            SkipSpace();
            if (_position >= _end || _buffer[_position] != bracket)
            {
                throw Unexpected(expected);
            }
            Enter(isArray);
            _position++;
        }

        /// <summary>Goes a level down.</summary>
        private protected void Enter(bool isArray)
        {
            if (_depth == _levels.Length - 1)
            {
                throw Error("nested deeper than " + _depth + " levels");
            }
            _levels[++_depth] = new Level { IsArray = isArray, Index = -1 };
        }

        /// <summary>
        /// Goes behind the quote that opens the next name. False when the object has ended.
        /// </summary>
        private bool NextQuote()
        {
            SkipSpace();
            _levels[_depth].NameLength = 0;
            byte next = _position < _end ? _buffer[_position] : (byte)0;
            if (next == (byte)'}')
            {
                _position++;
                _depth--;
                return false;
            }
            if (++_levels[_depth].Index > 0)
            {
                if (next != (byte)',')
                {
                    throw Unexpected("a comma or the end of the object");
                }
                _position++;
                SkipSpace();
                next = _position < _end ? _buffer[_position] : (byte)0;
            }
            if (next != (byte)'"')
            {
                throw Unexpected("a name in quotes");
            }
            _position++;
            return true;
        }

        private void AfterName(int start, int length)
        {
            _levels[_depth].NameStart = start;
            _levels[_depth].NameLength = length;
            if (_position >= _end || _buffer[_position] != (byte)':')
            {
                SkipSpace();
                if (_position >= _end || _buffer[_position] != (byte)':')
                {
                    throw Unexpected("a colon");
                }
            }
            _position++;
        }

        private bool TakeLiteral(string literal)
        {
            if (!IsLiteralNext(literal))
            {
                return false;
            }
            _position += literal.Length;
            return true;
        }

        private bool IsLiteralNext(string literal)
        {
            if (_end - _position < literal.Length)
            {
                return false;
            }
            for (int i = 0; i < literal.Length; i++)
            {
                if (_buffer[_position + i] != literal[i])
                {
                    return false;
                }
            }
            return true;
        }

        /// <summary>An object or array that was entered, and how far it has been read.</summary>
        private protected struct Level
        {
            public bool IsArray;
            public int Index; // of the member or element, -1 before the first
            public int NameStart; // the raw name, decoded only where a path is asked for
            public int NameLength;
            public int Left; // members or elements, in CBOR
            public int ElementTag; // of a typed array in CBOR. Else 0
        }
    }
}
