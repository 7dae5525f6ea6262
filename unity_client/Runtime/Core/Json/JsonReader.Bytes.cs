// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway.Json
{
    public partial class JsonReader
    {
        private const int NoBase64 = -1;

        private static readonly byte[] Base64Values = MakeBase64Values(); // 64: none of the alphabet

        /// <summary>
        /// Reads octets: base64 (RFC 4648, with its padding, no line breaks), or an array of integers from 0
        /// to 255.
        /// </summary>
        /// <param name="length">How many there must be. -1 takes any number.</param>
        public byte[] ReadBytes(int length = -1)
        {
            return ReadBytes(null, length);
        }

        /// <summary>Like the other. Fills *previous* again if that has the right length.</summary>
        public virtual byte[] ReadBytes(byte[] previous, int length = -1)
        {
            JsonKind kind = Kind;
            if (kind == JsonKind.Array)
            {
                return ReadUInt8s(previous, length);
            }
            if (kind != JsonKind.String)
            {
                throw Unexpected("base64 or an array of integers");
            }
            int quote = _position;
            byte[] octets = previous;
            int count = ReadBase64(ref octets, true);
            if (length >= 0 && count != length)
            {
                _position = quote;
                throw Error("expected " + length + " octets, got " + count);
            }
            return octets;
        }

        /// <summary>Reads octets into a buffer, in whose place a longer one is put if it is too short.</summary>
        /// <returns>Their number. Bytes behind them in the buffer are of earlier ones.</returns>
        public virtual int ReadBytes(ref byte[] buffer)
        {
            if (Kind == JsonKind.String)
            {
                return ReadBase64(ref buffer, false);
            }
            byte[] octets = ReadBytes(null);
            buffer = RoomForBytes(buffer, octets.Length, false);
            Buffer.BlockCopy(octets, 0, buffer, 0, octets.Length);
            return octets.Length;
        }

        /// <summary>The array for so many octets: this one, or a new one if it is too short, or not exact.</summary>
        private protected static byte[] RoomForBytes(byte[] buffer, int count, bool isExact)
        {
            if (buffer != null && (isExact ? buffer.Length == count : buffer.Length >= count))
            {
                return buffer;
            }
            // the next one may be a little longer
            return count == 0 ? Array.Empty<byte>() : new byte[isExact ? count : count + count / 4];
        }

        // At the quote.
        private int ReadBase64(ref byte[] octets, bool isExact)
        {
            int quote = _position;
            int closing = Array.IndexOf(_buffer, (byte)'"', quote + 1, _end - quote - 1);
            int count = closing < 0
                ? NoBase64
                : DecodeBase64(_buffer, quote + 1, closing - quote - 1, ref octets, isExact);
            _position = closing + 1;
            if (count == NoBase64)
            {
                // Some writers escape the slash, which base64 has. Or it is not base64, or not JSON.
                _position = quote + 1;
                count = DecodeBase64(DecodeString(), ref octets, isExact);
            }
            if (count == NoBase64)
            {
                _position = quote;
                throw Error("expected base64, got another text");
            }
            return count;
        }

        private static int DecodeBase64(string text, ref byte[] octets, bool isExact)
        {
            byte[] plain = new byte[text.Length];
            for (int i = 0; i < plain.Length; i++)
            {
                plain[i] = text[i] < 0x80 ? (byte)text[i] : (byte)0;
            }
            return DecodeBase64(plain, 0, plain.Length, ref octets, isExact);
        }

        /// <summary>Returns how many octets it was, or <see cref="NoBase64"/>.</summary>
        private static int DecodeBase64(byte[] text, int start, int count, ref byte[] decoded, bool isExact)
        {
            if (count % 4 != 0)
            {
                return NoBase64;
            }
            if (count == 0)
            {
                decoded = RoomForBytes(decoded, 0, isExact);
                return 0;
            }
            int end = start + count;
            int padding = text[end - 1] != (byte)'=' ? 0 : text[end - 2] != (byte)'=' ? 1 : 2;
            int length = count / 4 * 3 - padding;
            byte[] octets = RoomForBytes(decoded, length, isExact);
            byte[] values = Base64Values;
            int to = 0;
            int seen = 0; // all values together: has the bit 64 as soon as one was invalid
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
                    return NoBase64;
                }
            }
            decoded = octets;
            return seen < 64 ? length : NoBase64;
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
