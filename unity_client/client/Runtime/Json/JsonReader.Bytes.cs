// SPDX-License-Identifier: Apache-2.0
using System;
using System.Buffers;
using System.Buffers.Text;
using System.Text;

namespace Ros2Gateway.Json
{
    public partial class JsonReader
    {
        // The digits before one = and before two whose bits that stand for nothing are zero. With others two texts
        // would mean the same octets.
        private const string BeforeOne = "AEIMQUYcgkosw048";
        private const string BeforeTwo = "AQgw";

        /// <summary>
        /// Reads octets: base64 (RFC 4648, with its padding, no line breaks), or an array of integers from 0
        /// to 255. Fills *previous* again if that has the right length.
        /// </summary>
        /// <param name="length">How many there must be. -1 takes any number.</param>
        public byte[] ReadBytes(byte[] previous = null, int length = -1)
        {
            byte[] octets = previous;
            int count = ReadOctets(ref octets, true);
            return length < 0 || count == length
                ? octets : throw Error("expected " + length + " octets, got " + count);
        }

        /// <summary>Reads octets into a buffer, in whose place another one is put if it does not fit.</summary>
        /// <returns>Their number. Bytes behind them in the buffer are of earlier ones.</returns>
        public int ReadBytes(ref byte[] buffer) => ReadOctets(ref buffer, false);

        private int ReadOctets(ref byte[] octets, bool isExact)
        {
            if (Kind != JsonKind.Array)
            {
                return ReadString(ref octets, isExact);
            }
            octets = ReadArray(octets, -1, 64, reader => reader.ReadUInt8());
            return octets.Length;
        }

        /// <summary>Reads octets that are written as a text.</summary>
        private protected virtual int ReadString(ref byte[] octets, bool isExact)
        {
            if (Kind != JsonKind.String)
            {
                throw Unexpected("base64 or an array of integers");
            }
            int quote = _position++;
            Span<byte> text = new(_buffer, _position, _end - _position);
            int length = text.IndexOfAny((byte)'"', (byte)'\\');
            if (length >= 0 && text[length] == (byte)'"')
            {
                text = text.Slice(0, length);
                _position += length + 1;
            }
            else
            {
                text = Encoding.UTF8.GetBytes(DecodeString()); // some writers escape the slash, which base64 has
            }
            if (!TryDecode(text, ref octets, out int count, isExact))
            {
                _position = quote;
                throw Error("expected base64, got another text");
            }
            return count;
        }

        private static bool TryDecode(Span<byte> text, ref byte[] octets, out int count, bool isExact)
        {
            int length = text.Length;
            int padding = length < 4 || text[length - 1] != (byte)'=' ? 0 : text[length - 2] != (byte)'=' ? 1 : 2;
            count = length / 4 * 3 - padding;
            if (length % 4 != 0
                || (padding > 0 && (padding == 1 ? BeforeOne : BeforeTwo).IndexOf((char)text[length - 1 - padding]) < 0))
            {
                return false;
            }
            octets = RoomForBytes(octets, count, isExact);
            return Base64.DecodeFromUtf8(text, octets, out _, out int written) == OperationStatus.Done
                && written == count; // some decoders pass over white space
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
    }
}
