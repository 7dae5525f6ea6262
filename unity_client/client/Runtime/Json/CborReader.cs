// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway.Json
{
    /// <summary>
    /// Reads CBOR (RFC 8949) as a gateway sends it in the place of JSON. Lengths that are stated, maps with texts
    /// as keys, byte strings for octets, typed arrays (RFC 8746, little-endian) for numbers. Used like its base.
    /// </summary>
    public sealed partial class CborReader : JsonReader
    {
        private const int Unsigned = 0; // major types
        private const int Negative = 1;
        private const int Bytes = 2;
        private const int Text = 3;
        private const int ArrayOfAny = 4;
        private const int Map = 5;
        private const int Tag = 6;

        private const int NoHead = -1; // the end, or an element of a typed array

        /// <summary>Whether a frame is CBOR: a map in it begins with a byte that begins nothing in JSON.</summary>
        internal static bool Begins(byte[] frame, int count) => count > 0 && frame[0] >> 5 == Map;

        private protected override JsonKind? Next() =>
            _levels[_depth].ElementTag != 0 ? JsonKind.Number : (NextHead >> 5) switch
            {
                NoHead => JsonKind.End,
                Unsigned or Negative => JsonKind.Number,
                Bytes or Text => JsonKind.String,
                ArrayOfAny or Tag => JsonKind.Array,
                Map => JsonKind.Object,
                _ => NextHead switch
                {
                    FalseByte or TrueByte => JsonKind.Boolean,
                    NullByte or UndefinedByte => JsonKind.Null,
                    HalfByte or SingleByte or DoubleByte => JsonKind.Number,
                    _ => (JsonKind?)null,
                },
            };

        // The first byte of the next item
        private int NextHead => _levels[_depth].ElementTag != 0 || _position >= _end ? NoHead : _buffer[_position];

        /// <inheritdoc/>
        public override void BeginObject() => Enter(false, Sized(Map, "an object"), 0);

        /// <inheritdoc/>
        public override bool NextMember(JsonMembers members, ref int member)
        {
            int length = NextKey();
            if (length >= 0)
            {
                member = members.IndexOf(_buffer, _position - length, length, member + 1);
            }
            return length >= 0;
        }

        /// <inheritdoc/>
        public override string NextName()
        {
            int length = NextKey();
            return length < 0 ? null : MakeString(_position - length, length);
        }

        /// <inheritdoc/>
        public override void BeginArray()
        {
            int tag = TakeTypedHead(out int bytes);
            Enter(true, tag != 0 ? bytes / ElementBytes(tag) : Sized(ArrayOfAny, "an array"), tag);
        }

        /// <inheritdoc/>
        public override bool NextElement()
        {
            if (_levels[_depth].Left == 0)
            {
                _depth--;
                return false;
            }
            _levels[_depth].Left--;
            _levels[_depth].Index++;
            return true;
        }

        /// <inheritdoc/>
        public override bool ReadBool()
        {
            int next = NextHead;
            if (next != FalseByte && next != TrueByte)
            {
                throw Unexpected("true or false");
            }
            _position++;
            return next == TrueByte;
        }

        /// <inheritdoc/>
        public override bool TryReadNull()
        {
            int next = NextHead;
            bool isNull = next == NullByte || next == UndefinedByte;
            _position += isNull ? 1 : 0;
            return isNull;
        }

        /// <summary>Reads a text. Octets are the base64 that JSON has for them.</summary>
        public override string ReadString()
        {
            bool isText = NextHead >> 5 != Bytes;
            int count = Sized(isText ? Text : Bytes, "a string");
            _position += count;
            return isText ? MakeString(_position - count, count)
                : Convert.ToBase64String(_buffer, _position - count, count);
        }

        private protected override int ReadString(ref byte[] octets, bool isExact)
        {
            int count = Sized(Bytes, "octets");
            octets = RoomForBytes(octets, count, isExact);
            Buffer.BlockCopy(_buffer, _position, octets, 0, count);
            _position += count;
            return count;
        }

        /// <inheritdoc/>
        public override void End()
        {
            if (_position < _end)
            {
                throw Unexpected("the end");
            }
        }

        /// <summary>Passes over one value. Its lengths are checked, not what is inside.</summary>
        public override void Skip()
        {
            int tag = _levels[_depth].ElementTag;
            if (tag != 0)
            {
                _position += ElementBytes(tag);
                return;
            }
            for (long pending = 1; pending > 0; pending--)
            {
                int start = _position;
                switch (Head(out ulong argument))
                {
                    case Bytes:
                    case Text:
                        _position += Fitting(argument, start);
                        break;
                    case ArrayOfAny:
                        pending += Fitting(argument, start);
                        break;
                    case Map:
                        pending += 2L * Fitting(argument, start);
                        break;
                    case Tag:
                        pending++;
                        break;
                }
            }
        }

        // Each takes a byte or more, and so many are there.
        private protected override int CountAhead() => _levels[_depth].Left;

        /// <summary>Goes behind the next key. Its length in bytes, -1 when the object has ended.</summary>
        private int NextKey()
        {
            _levels[_depth].NameLength = 0;
            if (_levels[_depth].Left == 0)
            {
                _depth--;
                return -1;
            }
            int length = Sized(Text, "a name");
            _levels[_depth].Left--;
            _levels[_depth].NameStart = _position;
            _levels[_depth].NameLength = length;
            _position += length;
            return length;
        }

        private void Enter(bool isArray, int count, int elementTag)
        {
            Enter(isArray);
            _levels[_depth].Left = count;
            _levels[_depth].ElementTag = elementTag;
        }

        /// <summary>The number of bytes or items of what comes next.</summary>
        private int Sized(int major, string words)
        {
            int start = _position;
            if (NextHead >> 5 != major)
            {
                throw Unexpected(words);
            }
            Head(out ulong count);
            return Fitting(count, start);
        }

        /// <summary>A number of bytes, or of items of a byte or more, that are there.</summary>
        private int Fitting(ulong count, int start)
        {
            int left = _end - _position;
            if (count > (ulong)left)
            {
                _position = start;
                throw Error("need " + count + " bytes, " + left + " are there");
            }
            return (int)count;
        }

        /// <summary>Reads the major type of an item, and the number that comes with it.</summary>
        private int Head(out ulong argument)
        {
            if (_position >= _end)
            {
                throw Unexpected("an item");
            }
            int first = _buffer[_position];
            int information = first & 31;
            if (information < 24)
            {
                argument = (ulong)information;
                _position++;
                return first >> 5;
            }
            if (information > 27)
            {
                throw Error("an item of indefinite length");
            }
            int bytes = 1 << (information - 24);
            if (_end - _position - 1 < bytes)
            {
                throw Error("need " + (1 + bytes) + " bytes, " + (_end - _position) + " are there");
            }
            argument = 0;
            for (int i = 1; i <= bytes; i++)
            {
                argument = (argument << 8) | _buffer[_position + i];
            }
            _position += 1 + bytes;
            return first >> 5;
        }

        private string MakeString(int start, int length)
        {
            bool isShort = length <= LongestCached;
            for (int i = start; isShort && i < start + length; i++)
            {
                isShort = _buffer[i] < 0x80;
            }
            try
            {
                return isShort ? Cached(start, length) : StrictUtf8.GetString(_buffer, start, length);
            }
            catch (ArgumentException)
            {
                _position = start;
                throw Error("a string is not UTF-8");
            }
        }
    }
}
