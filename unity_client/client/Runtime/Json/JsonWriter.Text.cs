// SPDX-License-Identifier: Apache-2.0
using System;
using System.Globalization;
using System.Text;

namespace Ros2Gateway.Json
{
    public sealed partial class JsonWriter
    {
        /// <summary>Writes octets as base64 (RFC 4648) in a text. Null is the empty text.</summary>
        public void Base64(byte[] v)
        {
            v ??= Array.Empty<byte>();
            int digits = checked((int)((v.Length + 2L) / 3 * 4));
            BeginValue(checked(digits + 2));
            _buffer[_count++] = (byte)'"';
            System.Buffers.Text.Base64.EncodeToUtf8(v, new Span<byte>(_buffer, _count, digits), out _, out _);
            _count += digits;
            _buffer[_count++] = (byte)'"';
        }

        private void WriteText(string text)
        {
            BeginValue(text.Length + 2); // right for what is mostly written, plain ASCII
            _buffer[_count++] = (byte)'"';
            int i = 0;
            for (; i < text.Length && text[i] < 0x80 && !NeedsEscape(text[i]); i++)
            {
                _buffer[_count++] = (byte)text[i];
            }
            while (i < text.Length)
            {
                int run = i;
                while (i < text.Length && !NeedsEscape(text[i]))
                {
                    i++;
                }
                Reserve(Encoding.UTF8.GetMaxByteCount(i - run));
                _count += Encoding.UTF8.GetBytes(text, run, i - run, _buffer, _count);
                if (i < text.Length)
                {
                    Escape(text[i++]);
                }
            }
            Reserve(1);
            _buffer[_count++] = (byte)'"';
        }

        private static bool NeedsEscape(char character) => character < 0x20 || character == '"' || character == '\\';

        private void Escape(char character)
        {
            int known = JsonReader.EscapedCharacters.IndexOf(character);
            string escape = known >= 0 ? "\\" + JsonReader.EscapeLetters[known]
                : "\\u" + ((int)character).ToString("x4", CultureInfo.InvariantCulture);
            Reserve(escape.Length);
            _count += Encoding.ASCII.GetBytes(escape, 0, escape.Length, _buffer, _count);
        }
    }
}
