// SPDX-License-Identifier: Apache-2.0
using System;
using System.IO;
using System.IO.Compression;

namespace Ros2Gateway.Pictures
{
    /// <summary>
    /// Reads the grey PNGs that the gateway makes of maps (8 bits) and of depth (16 bits). Unity's own reader
    /// takes the main thread, and of 16 bits it leaves 8.
    /// </summary>
    public sealed class GreyPng
    {
        /// <summary>A map of more cells is refused: these are 64 MB, and 400 m a side at 5 cm.</summary>
        public const int MaxPixelsOf8Bits = 1 << 26;

        /// <summary>A depth picture of more pixels is refused: these are 32 MB, and more than cameras have.</summary>
        public const int MaxPixelsOf16Bits = 1 << 24;

        private const int MaxExpansion = 1032; // 258 bytes, the longest repetition, take 2 bits at least
        private const int HeaderBytes = 33; // the signature and the first chunk, which begins with the size
        private const int ChunkBytes = 12; // length, name and checksum
        private const int ZlibBytes = 2; // before the compressed data

        private static readonly byte[] Signature = { 137, 80, 78, 71, 13, 10, 26, 10 };

        private byte[] _stream = new byte[0];
        private readonly int _bytesPerPixel;

        /// <param name="bytesPerPixel">1 for maps, 2 for depth. Pictures of the other kind are refused.</param>
        public GreyPng(int bytesPerPixel)
        {
            if (bytesPerPixel != 1 && bytesPerPixel != 2)
            {
                throw new ArgumentOutOfRangeException("bytesPerPixel", bytesPerPixel, "must be 1 or 2");
            }
            _bytesPerPixel = bytesPerPixel;
        }

        /// <summary>Pixels a row.</summary>
        public int Width { get; private set; }

        /// <summary>Rows.</summary>
        public int Height { get; private set; }

        /// <summary>
        /// The pixels by rows, in the file's order, of two bytes the high one first. Longer than needed, and used again.
        /// </summary>
        public byte[] Pixels { get; private set; }

        /// <summary>Reads a picture. Returns what is wrong with it, or null.</summary>
        public string Read(byte[] png)
        {
            try
            {
                Decode(png ?? new byte[0]);
                return null;
            }
            catch (FormatException error)
            {
                return "the image cannot be read: " + error.Message;
            }
        }

        private void Decode(byte[] png)
        {
            if (png.Length < HeaderBytes || !IsSigned(png))
            {
                throw new FormatException("it is not a PNG");
            }
            long width = Word(png, 16), height = Word(png, 20);
            int depth = png[24], color = png[25], interlace = png[28];
            if (color != 0 || depth != 8 && depth != 16 || interlace != 0)
            {
                throw new FormatException("it is not a gray PNG of 8 or 16 bits");
            }
            if (depth != 8 * _bytesPerPixel)
            {
                throw new FormatException("it has " + depth + " bits a pixel, must have " + 8 * _bytesPerPixel);
            }
            int most = _bytesPerPixel == 1 ? MaxPixelsOf8Bits : MaxPixelsOf16Bits;
            if (width == 0 || height == 0 || width > most || height > most || width * height > most)
            {
                throw new FormatException(width + " by " + height + " pixels, at most " + most);
            }
            int row = (int)width * _bytesPerPixel;
            int size = (int)height * (row + 1); // each row begins with its filter
            int length = Gather(png);
            if (size > (long)MaxExpansion * length) // before there is room for what a few bytes only claim
            {
                throw new FormatException(width + " by " + height + " pixels, more than " + length + " bytes can hold");
            }
            byte[] pixels = Pixels ?? new byte[0];
            Grow(ref pixels, size);
            Inflate(_stream, length, pixels, size);
            Width = (int)width;
            Height = (int)height;
            Pixels = pixels;
            for (int y = 0; y < Height; y++)
            {
                Unfilter(y, row);
            }
        }

        /// <summary>Joins the parts of the compressed stream.</summary>
        private int Gather(byte[] png)
        {
            Grow(ref _stream, png.Length);
            int at = HeaderBytes, count = 0;
            while (at + ChunkBytes <= png.Length)
            {
                long length = Word(png, at);
                if (length > png.Length - at - ChunkBytes)
                {
                    throw new FormatException("it ends too early");
                }
                bool isData = png[at + 4] == 'I' && png[at + 5] == 'D' && png[at + 6] == 'A' && png[at + 7] == 'T';
                if (isData)
                {
                    Buffer.BlockCopy(png, at + 8, _stream, count, (int)length);
                    count += (int)length;
                }
                at += ChunkBytes + (int)length;
            }
            return count;
        }

        /// <summary>Fills *output* up to *count* bytes.</summary>
        private static void Inflate(byte[] stream, int length, byte[] output, int count)
        {
            bool isZlib = length > ZlibBytes && (stream[0] & 15) == 8 && (stream[0] << 8 | stream[1]) % 31 == 0
                && (stream[1] & 32) == 0;
            if (!isZlib)
            {
                throw new FormatException("not a zlib stream");
            }
            try
            {
                using (MemoryStream input = new(stream, ZlibBytes, length - ZlibBytes))
                using (DeflateStream inflater = new(input, CompressionMode.Decompress))
                {
                    int written = 0, more = 1;
                    while (written < count && more > 0)
                    {
                        more = inflater.Read(output, written, count - written);
                        written += more;
                    }
                    if (written < count || inflater.ReadByte() >= 0)
                    {
                        throw new FormatException("it holds fewer or more bytes than its size needs");
                    }
                }
            }
            catch (IOException error) // of Mono
            {
                throw new FormatException(error.Message);
            }
            catch (InvalidDataException error)
            {
                throw new FormatException(error.Message);
            }
        }

        // In place: pixels lie before the bytes that they are made of, by one for each row.
        private void Unfilter(int y, int row)
        {
            byte[] pixels = Pixels;
            int from = y * (row + 1), to = y * row, bytes = _bytesPerPixel;
            int filter = pixels[from++];
            if (filter > 4)
            {
                throw new FormatException("a row has the unknown filter " + filter);
            }
            for (int i = 0; i < row; i++)
            {
                int left = i >= bytes ? pixels[to + i - bytes] : 0;
                int up = y > 0 ? pixels[to + i - row] : 0;
                int corner = y > 0 && i >= bytes ? pixels[to + i - row - bytes] : 0;
                int guess = 0;
                switch (filter)
                {
                    case 1:
                        guess = left;
                        break;
                    case 2:
                        guess = up;
                        break;
                    case 3:
                        guess = left + up >> 1;
                        break;
                    case 4:
                        guess = Paeth(left, up, corner);
                        break;
                    default:
                        break;
                }
                pixels[to + i] = (byte)(pixels[from + i] + guess);
            }
        }

        private static int Paeth(int left, int up, int corner)
        {
            int sum = left + up - corner;
            int toLeft = Math.Abs(sum - left), toUp = Math.Abs(sum - up), toCorner = Math.Abs(sum - corner);
            return toLeft <= toUp && toLeft <= toCorner ? left : toUp <= toCorner ? up : corner;
        }

        private static bool IsSigned(byte[] png)
        {
            for (int i = 0; i < Signature.Length; i++)
            {
                if (png[i] != Signature[i])
                {
                    return false;
                }
            }
            return true;
        }

        private static long Word(byte[] bytes, int at) =>
            (long)bytes[at] << 24 | (long)bytes[at + 1] << 16 | (long)bytes[at + 2] << 8 | bytes[at + 3];

        private static void Grow(ref byte[] buffer, int length)
        {
            if (buffer.Length < length)
            {
                buffer = new byte[length];
            }
        }
    }
}
