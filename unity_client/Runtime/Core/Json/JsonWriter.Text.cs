// SPDX-License-Identifier: Apache-2.0
namespace Ros2Gateway.Json
{
    public sealed partial class JsonWriter
    {
        private const string HexDigits = "0123456789abcdef";
        private const string Alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

        private static readonly byte[] Base64Digits = System.Text.Encoding.ASCII.GetBytes(Alphabet);

        /// <summary>Writes octets as base64 (RFC 4648) in a text. Null is the empty text.</summary>
        public void Base64(byte[] v)
        {
            int length = v == null ? 0 : v.Length;
            int digits = checked((int)((length + 2L) / 3 * 4));
            BeginValue(checked(digits + 2));
            byte[] to = _buffer;
            byte[] alphabet = Base64Digits;
            int at = _count;
            to[at++] = (byte)'"';
            int whole = length - length % 3;
            for (int i = 0; i < whole; i += 3)
            {
                int three = (v[i] << 16) | (v[i + 1] << 8) | v[i + 2];
                to[at] = alphabet[three >> 18];
                to[at + 1] = alphabet[(three >> 12) & 63];
                to[at + 2] = alphabet[(three >> 6) & 63];
                to[at + 3] = alphabet[three & 63];
                at += 4;
            }
            if (whole < length)
            {
                bool isOne = length - whole == 1;
                int rest = (v[whole] << 16) | (isOne ? 0 : v[whole + 1] << 8);
                to[at] = alphabet[rest >> 18];
                to[at + 1] = alphabet[(rest >> 12) & 63];
                to[at + 2] = isOne ? (byte)'=' : alphabet[(rest >> 6) & 63];
                to[at + 3] = (byte)'=';
                at += 4;
            }
            to[at++] = (byte)'"';
            _count = at;
        }

        private void WriteText(string text)
        {
            BeginValue(text.Length + 2); // right for what is mostly written, plain ASCII
            _buffer[_count++] = (byte)'"';
            int last = text.Length;
            int i = 0;
            for (; i < last; i++)
            {
                char next = text[i];
                if (next < 0x20 || next >= 0x80 || next == '"' || next == '\\')
                {
                    break;
                }
                _buffer[_count++] = (byte)next;
            }
            while (i < last)
            {
                i += WriteCharacter(text, i, last - i);
            }
            Reserve(1);
            _buffer[_count++] = (byte)'"';
        }

        /// <summary>Writes one character of a text. Returns how many chars of it that takes.</summary>
        private int WriteCharacter(string text, int at, int last)
        {
            Reserve(last + 7); // the rest as plain ASCII, an escape, the quote
            int point = text[at];
            int taken = 1;
            if (char.IsSurrogate(text[at]))
            {
                bool isPair = last > 1 && char.IsSurrogatePair(text[at], text[at + 1]);
                point = isPair ? char.ConvertToUtf32(text[at], text[at + 1]) : 0xFFFD;
                taken = isPair ? 2 : 1;
            }
            if (point < 0x20 || point == '"' || point == '\\')
            {
                WriteEscape((char)point);
            }
            else if (point < 0x80)
            {
                _buffer[_count++] = (byte)point;
            }
            else if (point < 0x800)
            {
                _buffer[_count++] = (byte)(0xC0 | (point >> 6));
                _buffer[_count++] = (byte)(0x80 | (point & 0x3F));
            }
            else
            {
                if (point < 0x10000)
                {
                    _buffer[_count++] = (byte)(0xE0 | (point >> 12));
                }
                else
                {
                    _buffer[_count++] = (byte)(0xF0 | (point >> 18));
                    _buffer[_count++] = (byte)(0x80 | ((point >> 12) & 0x3F));
                }
                _buffer[_count++] = (byte)(0x80 | ((point >> 6) & 0x3F));
                _buffer[_count++] = (byte)(0x80 | (point & 0x3F));
            }
            return taken;
        }

        private void WriteEscape(char control)
        {
            _buffer[_count++] = (byte)'\\';
            switch (control)
            {
                case '"':
                case '\\':
                    _buffer[_count++] = (byte)control;
                    return;
                case '\n':
                    _buffer[_count++] = (byte)'n';
                    return;
                case '\r':
                    _buffer[_count++] = (byte)'r';
                    return;
                case '\t':
                    _buffer[_count++] = (byte)'t';
                    return;
            }
            _buffer[_count++] = (byte)'u';
            _buffer[_count++] = (byte)'0';
            _buffer[_count++] = (byte)'0';
            _buffer[_count++] = (byte)HexDigits[control >> 4];
            _buffer[_count++] = (byte)HexDigits[control & 15];
        }
    }
}
