// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway.Json
{
    public sealed partial class JsonReader
    {
        private static readonly byte[] Base64Values = MakeBase64Values(); // 64: none of the alphabet

        /// <summary>
        /// Reads octets: base64 (RFC 4648, with its padding, no line breaks), or an array of integers from 0
        /// to 255.
        /// </summary>
        /// <param name="length">How many there must be; -1 takes any number.</param>
        public byte[] ReadBytes(int length = -1)
        {
            JsonKind kind = Kind;
            if (kind == JsonKind.Array)
            {
                return ReadUInt8s(length);
            }
            if (kind != JsonKind.String)
            {
                throw Unexpected("base64 or an array of integers");
            }
            int quote = _position;
            int closing = Array.IndexOf(_buffer, (byte)'"', quote + 1, _end - quote - 1);
            byte[] octets = closing < 0 ? null : DecodeBase64(_buffer, quote + 1, closing - quote - 1);
            _position = closing + 1;
            if (octets == null)
            {
                // Some writers escape the slash, which base64 has; or it is none, or no JSON.
                _position = quote + 1;
                octets = DecodeBase64(DecodeString());
            }
            if (octets == null)
            {
                _position = quote;
                throw Error("expected base64, got another text");
            }
            if (length >= 0 && octets.Length != length)
            {
                _position = quote;
                throw Error("expected " + length + " octets, got " + octets.Length);
            }
            return octets;
        }

        private static byte[] DecodeBase64(string text)
        {
            byte[] plain = new byte[text.Length];
            for (int i = 0; i < plain.Length; i++)
            {
                plain[i] = text[i] < 0x80 ? (byte)text[i] : (byte)0;
            }
            return DecodeBase64(plain, 0, plain.Length);
        }

        /// <summary>Returns null if the text is no base64.</summary>
        private static byte[] DecodeBase64(byte[] text, int start, int count)
        {
            if (count % 4 != 0)
            {
                return null;
            }
            if (count == 0)
            {
                return Array.Empty<byte>();
            }
            int end = start + count;
            int padding = text[end - 1] != (byte)'=' ? 0 : text[end - 2] != (byte)'=' ? 1 : 2;
            byte[] octets = new byte[count / 4 * 3 - padding];
            byte[] values = Base64Values;
            int to = 0;
            int seen = 0; // all values together: has the bit 64 as soon as one was none
            int whole = padding == 0 ? end : end - 4;
            for (int i = start; i < whole; i += 4)
            {
                int a = values[text[i]];
                int b = values[text[i + 1]];
                int c = values[text[i + 2]];
                int d = values[text[i + 3]];
                seen |= a | b | c | d;
                octets[to] = (byte)((a << 2) | (b >> 4));
                octets[to + 1] = (byte)((b << 4) | (c >> 2));
                octets[to + 2] = (byte)((c << 6) | d);
                to += 3;
            }
            if (padding > 0)
            {
                int a = values[text[whole]];
                int b = values[text[whole + 1]];
                int c = padding == 1 ? values[text[whole + 2]] : 0;
                seen |= a | b | c;
                octets[to] = (byte)((a << 2) | (b >> 4));
                if (padding == 1)
                {
                    octets[to + 1] = (byte)((b << 4) | (c >> 2));
                }
                // The bits that stand for nothing must be zero, or two texts would mean the same octets.
                if ((padding == 1 ? c & 3 : b & 15) != 0)
                {
                    return null;
                }
            }
            return seen < 64 ? octets : null;
        }

        private static byte[] MakeBase64Values()
        {
            const string Alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
            byte[] values = new byte[256];
            for (int i = 0; i < values.Length; i++)
            {
                values[i] = 64;
            }
            for (int i = 0; i < Alphabet.Length; i++)
            {
                values[Alphabet[i]] = (byte)i;
            }
            return values;
        }
    }
}
