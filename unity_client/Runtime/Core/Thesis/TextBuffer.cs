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
        public static implicit operator TextBuffer(StringBuilder text)
        {
            return new TextBuffer(text, null);
        }

        /// <summary>The array gets UTF-8, and a zero behind it where there is room for one.</summary>
        public static implicit operator TextBuffer(byte[] bytes)
        {
            return new TextBuffer(null, bytes);
        }

        /// <summary>How many bytes of a text it takes, if its caller says that it takes so many.</summary>
        internal uint Capacity(uint size)
        {
            if (_text != null)
            {
                return size; // a StringBuilder grows
            }
            return _bytes == null ? 0 : Math.Min(size, (uint)_bytes.Length);
        }

        /// <summary>Writes a text that fits. Returns its length in bytes.</summary>
        internal uint Write(string text)
        {
            if (_text != null)
            {
                _text.Length = 0;
                _text.Append(text);
                return Bytes(text);
            }
            if (_bytes == null)
            {
                return 0; // only an empty text fits
            }
            int written = Encoding.UTF8.GetBytes(text, 0, text.Length, _bytes, 0);
            if (written < _bytes.Length)
            {
                _bytes[written] = 0; // for those who read up to it, as in C
            }
            return (uint)written;
        }

        internal static uint Bytes(string text)
        {
            return (uint)Encoding.UTF8.GetByteCount(text);
        }
    }
}
