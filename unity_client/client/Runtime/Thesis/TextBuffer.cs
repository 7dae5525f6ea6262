// SPDX-License-Identifier: Apache-2.0
using System;
using System.Text;

namespace Ros2Gateway.Thesis
{
    /// <summary>
    /// The place for the text of a poll: a StringBuilder or a byte array, as a DllImport of the time declared a char*.
    /// </summary>
    public struct TextBuffer
    {
        private readonly StringBuilder _text;
        private readonly byte[] _bytes;

        private TextBuffer(StringBuilder text, byte[] bytes)
        {
            _text = text;
            _bytes = bytes;
        }

        /// <summary>The StringBuilder's text is replaced.</summary>
        public static implicit operator TextBuffer(StringBuilder text) => new TextBuffer(text, null);

        /// <summary>The array gets UTF-8, and a zero behind it where there is room for one.</summary>
        public static implicit operator TextBuffer(byte[] bytes) => new TextBuffer(null, bytes);

        /// <summary>
        /// Writes a text, or its start if so many bytes are too few: whole characters. Returns how many bytes it wrote.
        /// </summary>
        internal int Write(string text, int size)
        {
            byte[] encoded = Encoding.UTF8.GetBytes(text);
            int room = _text != null ? size : _bytes == null ? 0 : Math.Min(size, _bytes.Length); // a StringBuilder grows
            int count = Math.Min(encoded.Length, room);
            while (count < encoded.Length && count > 0 && (encoded[count] & 0xC0) == 0x80) // inside of a character
            {
                count--;
            }
            if (_text != null)
            {
                _text.Length = 0;
                _text.Append(Encoding.UTF8.GetString(encoded, 0, count));
            }
            else if (_bytes != null)
            {
                Array.Copy(encoded, _bytes, count);
                if (count < _bytes.Length)
                {
                    _bytes[count] = 0; // for those who read up to it, as in C
                }
            }
            return count;
        }
    }
}
