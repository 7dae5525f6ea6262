// SPDX-License-Identifier: Apache-2.0
using System;
using System.Text;

namespace Ros2Gateway.Json
{
    /// <summary>
    /// Writes JSON as UTF-8 into a buffer that grows and is used again. Commas come by themselves. That names
    /// and values alternate and that what begins ends is up to the caller. One thread at a time.
    /// </summary>
    public sealed partial class JsonWriter
    {
        private const int FirstSize = 256;
        private const int LargestKept = 1 << 20; // bytes: one huge message must not be paid forever after
        private const int LargestArray = 0x7FFFFFC7; // bytes, as .NET has it

        private byte[] _buffer = new byte[FirstSize];
        private int _count;
        private bool _needsComma;

        /// <summary>The written bytes, the first <see cref="Count"/> of them. Another array after the next
        /// write that it has no room for.</summary>
        public byte[] Buffer => _buffer;

        /// <summary>How many bytes were written.</summary>
        public int Count => _count;

        /// <summary>Starts again.</summary>
        public void Clear()
        {
            if (_buffer.Length > LargestKept)
            {
                _buffer = new byte[FirstSize];
            }
            _count = 0;
            _needsComma = false;
        }

        /// <summary>Begins an object. Its members follow as names and values.</summary>
        public void BeginObject() => Begin((byte)'{');

        /// <summary>Ends the object that was begun last.</summary>
        public void EndObject() => End((byte)'}');

        /// <summary>Begins an array. Its elements follow as values.</summary>
        public void BeginArray() => Begin((byte)'[');

        /// <summary>Ends the array that was begun last.</summary>
        public void EndArray() => End((byte)']');

        /// <summary>Writes the name of a member. Its value must follow.</summary>
        public JsonWriter Name(string name)
        {
            WriteText(name);
            Reserve(1);
            _buffer[_count++] = (byte)':';
            _needsComma = false;
            return this;
        }

        /// <summary>Writes null.</summary>
        public void Null() => Literal("null");

        /// <summary>Writes true or false.</summary>
        public void Value(bool v) => Literal(v ? "true" : "false");

        /// <summary>Writes an integer with all its digits.</summary>
        public void Value(long v)
        {
            BeginValue(DecimalText.LongestNumber);
            _count = DecimalText.WriteInt64(_buffer, _count, v);
        }

        /// <summary>Writes an integer with all its digits.</summary>
        public void Value(ulong v)
        {
            BeginValue(DecimalText.LongestNumber);
            _count = DecimalText.WriteUInt64(_buffer, _count, v);
        }

        /// <summary>
        /// Writes a number that reads back as the same float. JSON has no NaN, which is null, and
        /// no infinities, which are "Infinity" and "-Infinity".
        /// </summary>
        public void Value(float v) => Number(v, isSingle: true);

        /// <summary>Like the other, for a double.</summary>
        public void Value(double v) => Number(v, isSingle: false);

        /// <summary>
        /// Writes a text. Null is the empty text, for ROS has no null. Halves of surrogate pairs, which UTF-8
        /// has not, become U+FFFD.
        /// </summary>
        public void Value(string v) => WriteText(v ?? "");

        /// <summary>Writes a value that is JSON already. It is not looked at.</summary>
        public void Raw(byte[] utf8, int offset, int count)
        {
            BeginValue(count);
            System.Buffer.BlockCopy(utf8, offset, _buffer, _count, count);
            _count += count;
        }

        /// <summary>Returns a copy of what was written.</summary>
        public byte[] ToArray() => new ReadOnlySpan<byte>(_buffer, 0, _count).ToArray();

        /// <summary>Returns what was written, for people and tests.</summary>
        public override string ToString() => Encoding.UTF8.GetString(_buffer, 0, _count);

        private void Begin(byte bracket)
        {
            BeginValue(1);
            _buffer[_count++] = bracket;
            _needsComma = false;
        }

        private void End(byte bracket)
        {
            Reserve(1);
            _buffer[_count++] = bracket;
            _needsComma = true;
        }

        private void Number(double v, bool isSingle)
        {
            if (double.IsNaN(v) || double.IsInfinity(v))
            {
                Literal(double.IsNaN(v) ? "null" : v > 0 ? "\"Infinity\"" : "\"-Infinity\"");
                return;
            }
            BeginValue(DecimalText.LongestNumber);
            _count = DecimalText.Write(_buffer, _count, v, isSingle);
        }

        private void Literal(string text)
        {
            BeginValue(text.Length);
            for (int i = 0; i < text.Length; i++)
            {
                _buffer[_count++] = (byte)text[i];
            }
        }

        /// <summary>Writes the comma before a value, if it needs one, and makes room.</summary>
        private void BeginValue(int bytes)
        {
            Reserve(bytes + 1);
            if (_needsComma)
            {
                _buffer[_count++] = (byte)',';
            }
            _needsComma = true;
        }

        private void Reserve(int bytes)
        {
            if (bytes > _buffer.Length - _count)
            {
                int doubled = (int)Math.Min(2L * _buffer.Length, LargestArray);
                Array.Resize(ref _buffer, Math.Max(checked(_count + bytes), doubled));
            }
        }
    }
}
