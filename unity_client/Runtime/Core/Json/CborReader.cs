// SPDX-License-Identifier: Apache-2.0
using System;
using System.Text;

namespace Ros2Gateway.Json
{
    /// <summary>
    /// Reads CBOR (RFC 8949) as a gateway sends it in the place of JSON. Lengths that are stated, maps with texts
    /// as keys, byte strings for octets, typed arrays (RFC 8746, little-endian) for numbers. Used like its base.
    /// </summary>
    public sealed partial class CborReader : JsonReader
    {
        private const int MaxDepth = 64; // as in JSON

        private const int Unsigned = 0; // major types
        private const int Negative = 1;
        private const int Bytes = 2;
        private const int Text = 3;
        private const int ArrayOfAny = 4;
        private const int Map = 5;
        private const int Tag = 6;
        private const int Simple = 7;

        private static readonly Encoding StrictUtf8 = new UTF8Encoding(false, true);

        private readonly Level[] _levels = new Level[MaxDepth + 1];
        private int _depth;

        /// <summary>Whether a frame is CBOR: a map in it begins with a byte that begins nothing in JSON.</summary>
        internal static bool Begins(byte[] frame, int count)
        {
            return count > 0 && frame[0] >> 5 == Map;
        }

        /// <inheritdoc/>
        public override JsonKind Kind
        {
            get
            {
                if (_levels[_depth].ElementTag != 0)
                {
                    return JsonKind.Number;
                }
                if (_position >= _end)
                {
                    return JsonKind.End;
                }
                switch (_buffer[_position] >> 5)
                {
                    case Unsigned:
                    case Negative:
                        return JsonKind.Number;
                    case Bytes:
                    case Text:
                        return JsonKind.String;
                    case ArrayOfAny:
                    case Tag:
                        return JsonKind.Array;
                    case Map:
                        return JsonKind.Object;
                    default:
                        switch (_buffer[_position])
                        {
                            case FalseByte:
                            case TrueByte:
                                return JsonKind.Boolean;
                            case NullByte:
                            case UndefinedByte:
                                return JsonKind.Null;
                            case HalfByte:
                            case SingleByte:
                            case DoubleByte:
                                return JsonKind.Number;
                            default:
                                throw Unexpected("a value");
                        }
                }
            }
        }

        /// <inheritdoc/>
        public override void Reset(byte[] buffer, int offset, int count)
        {
            base.Reset(buffer, offset, count);
            _depth = 0;
            _levels[0].ElementTag = 0;
        }

        /// <inheritdoc/>
        public override void BeginObject()
        {
            long count = Count(Map, "an object");
            Enter(false, count, 0);
        }

        /// <inheritdoc/>
        public override bool NextMember(JsonMembers members, ref int member)
        {
            int length = NextKey();
            if (length < 0)
            {
                return false;
            }
            int start = _position - length;
            member = members.IsAt(member + 1, _buffer, start, length)
                ? member + 1
                : members.IndexOf(_buffer, start, length);
            return true;
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
            Expect("an array");
            int start = _position;
            int bytes;
            int tag = TakeTypedHead(out bytes);
            if (tag != 0)
            {
                Enter(true, bytes / ElementBytes(tag), tag);
                return;
            }
            _position = start;
            Enter(true, Count(ArrayOfAny, "an array"), 0);
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
            Expect("true or false");
            byte next = _position < _end ? _buffer[_position] : (byte)0;
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
            bool isNull = _levels[_depth].ElementTag == 0 && _position < _end
                && (_buffer[_position] == NullByte || _buffer[_position] == UndefinedByte);
            _position += isNull ? 1 : 0;
            return isNull;
        }

        /// <summary>Reads a text. Octets are the base64 that JSON has for them.</summary>
        public override string ReadString()
        {
            Expect("a string");
            int start = _position;
            ulong length;
            int major = _position < _end ? Head(out length) : HeadOfNothing(out length);
            if (major != Text && major != Bytes)
            {
                _position = start;
                throw Unexpected("a string");
            }
            int count = Fitting(length, start);
            int at = _position;
            _position += count;
            return major == Bytes ? Convert.ToBase64String(_buffer, at, count) : MakeString(at, count);
        }

        /// <inheritdoc/>
        public override byte[] ReadBytes(byte[] previous, int length = -1)
        {
            Expect("octets");
            int start = _position;
            if (start >= _end || _buffer[start] >> 5 != Bytes)
            {
                if (Kind == JsonKind.Array)
                {
                    return ReadUInt8s(previous, length);
                }
                throw Unexpected("octets");
            }
            ulong stated;
            Head(out stated);
            int count = Fitting(stated, start);
            if (length >= 0 && count != length)
            {
                _position = start;
                throw Error("expected " + length + " octets, got " + count);
            }
            byte[] octets = RoomForBytes(previous, count, true);
            Buffer.BlockCopy(_buffer, _position, octets, 0, count);
            _position += count;
            return octets;
        }

        /// <inheritdoc/>
        public override int ReadBytes(ref byte[] buffer)
        {
            Expect("octets");
            int start = _position;
            if (start >= _end || _buffer[start] >> 5 != Bytes)
            {
                byte[] octets = ReadBytes(null); // integers, or refused
                buffer = RoomForBytes(buffer, octets.Length, false);
                Buffer.BlockCopy(octets, 0, buffer, 0, octets.Length);
                return octets.Length;
            }
            ulong stated;
            Head(out stated);
            int count = Fitting(stated, start);
            buffer = RoomForBytes(buffer, count, false);
            Buffer.BlockCopy(_buffer, _position, buffer, 0, count);
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
            long pending = 1;
            while (pending > 0)
            {
                pending--;
                int start = _position;
                ulong argument;
                switch (Head(out argument))
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

        internal override int RoomFor(int length)
        {
            long left = _levels[_depth].Left; // each takes a byte or more, and so many are there
            return length >= 0 ? (int)Math.Min(length, left) : (int)Math.Max(left, 1);
        }

        internal override string DescribeNext()
        {
            if (_levels[_depth].ElementTag != 0)
            {
                return "a number";
            }
            if (_position >= _end)
            {
                return "the end";
            }
            switch (_buffer[_position] >> 5)
            {
                case Unsigned:
                case Negative:
                    return "a number";
                case Bytes:
                    return "octets";
                case Text:
                    return "a string";
                case ArrayOfAny:
                    return "an array";
                case Map:
                    return "an object";
                case Tag:
                    return "a tag";
                default:
                    byte next = _buffer[_position];
                    return next == FalseByte || next == TrueByte ? "a boolean"
                        : next == NullByte || next == UndefinedByte ? "null"
                        : next == HalfByte || next == SingleByte || next == DoubleByte ? "a number"
                        : "the byte " + next;
            }
        }

        internal override string Path()
        {
            var path = new StringBuilder();
            for (int i = 1; i <= _depth; i++)
            {
                Level level = _levels[i];
                if (level.IsArray && level.Index >= 0)
                {
                    path.Append('[').Append(level.Index).Append(']');
                }
                else if (!level.IsArray && level.NameLength > 0)
                {
                    int length = Math.Min(level.NameLength, LongestNameInPath);
                    path.Append(path.Length == 0 ? "" : ".");
                    path.Append(Encoding.UTF8.GetString(_buffer, level.NameStart, length));
                }
            }
            return path.ToString();
        }

        /// <summary>Goes behind the next key. Its length in bytes, -1 when the object has ended.</summary>
        private int NextKey()
        {
            _levels[_depth].NameLength = 0;
            if (_levels[_depth].Left == 0)
            {
                _depth--;
                return -1;
            }
            int start = _position;
            ulong stated;
            int major = _position < _end ? Head(out stated) : HeadOfNothing(out stated);
            if (major != Text)
            {
                _position = start;
                throw Unexpected("a name");
            }
            int length = Fitting(stated, start);
            _levels[_depth].Left--;
            _levels[_depth].NameStart = _position;
            _levels[_depth].NameLength = length;
            _position += length;
            return length;
        }

        private void Enter(bool isArray, long count, int elementTag)
        {
            if (_depth == MaxDepth)
            {
                throw Error("nested deeper than " + _depth + " levels");
            }
            _depth++;
            _levels[_depth].IsArray = isArray;
            _levels[_depth].Left = count;
            _levels[_depth].Index = -1;
            _levels[_depth].NameLength = 0;
            _levels[_depth].ElementTag = elementTag;
        }

        /// <summary>Refuses anything but a number in a typed array, whose elements have no heads.</summary>
        private void Expect(string words)
        {
            if (_levels[_depth].ElementTag != 0)
            {
                throw Unexpected(words);
            }
        }

        /// <summary>The number of items of what comes next. At least one byte is there for each.</summary>
        private int Count(int expected, string words)
        {
            Expect(words);
            int start = _position;
            ulong count;
            int major = _position < _end ? Head(out count) : HeadOfNothing(out count);
            if (major != expected)
            {
                _position = start;
                throw Unexpected(words);
            }
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

        private static int HeadOfNothing(out ulong argument)
        {
            argument = 0;
            return -1;
        }

        private string MakeString(int start, int length)
        {
            if (length == 0)
            {
                return "";
            }
            bool isShort = length <= LongestCached;
            for (int i = start; isShort && i < start + length; i++)
            {
                isShort = _buffer[i] < 0x80;
            }
            if (isShort)
            {
                return Cached(start, length);
            }
            try
            {
                return StrictUtf8.GetString(_buffer, start, length);
            }
            catch (ArgumentException)
            {
                _position = start;
                throw Error("a string is not UTF-8");
            }
        }

        /// <summary>An object or array that was entered, and how much of it is left.</summary>
        private struct Level
        {
            public bool IsArray;
            public long Left; // members or elements
            public long Index; // of the element, -1 before the first
            public int NameStart;
            public int NameLength;
            public int ElementTag; // of a typed array. Else 0
        }
    }
}
