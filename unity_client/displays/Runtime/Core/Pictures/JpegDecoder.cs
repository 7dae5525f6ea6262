// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway.Pictures
{
    /// <summary>
    /// Decodes baseline JPEGs (ISO/IEC 10918-1), grey or in colours, to the pixels that libjpeg makes of them.
    /// </summary>
    /// <remarks>
    /// For any thread, one picture at a time. It keeps its buffers for the next picture: of pictures of one
    /// size only the first allocates. The most that it allocates is bounded by <see cref="MaxPixels"/>, and
    /// by its bytes: where they are too few for its pixels, it is refused before.
    /// </remarks>
    public sealed class JpegDecoder
    {
        /// <summary>Larger pictures are refused: as pixels these are 64 MiB, and up to 48 on the way.</summary>
        public const int MaxPixels = 4096 * 4096;

        private const int BlocksPerByte = 4; // a block takes two bits or more: one code each for DC and AC

        private readonly JpegHeaders _headers = new();
        private readonly EntropyReader _entropy = new();
        private readonly InverseDct _transform = new();
        private readonly Upsampling[] _upsampling = { new Upsampling(), new Upsampling(), new Upsampling() };
        private readonly int[] _block = new int[64];

        /// <summary>Of the picture that was decoded last, in pixels.</summary>
        public int Width { get; private set; }

        /// <summary>Like <see cref="Width"/>.</summary>
        public int Height { get; private set; }

        /// <summary>Whether bytes begin as every JPEG does, of whatever kind.</summary>
        public static bool IsJpeg(byte[] bytes, int count) => JpegHeaders.Begins(bytes, count);

        /// <summary>Decodes a JPEG to RGBA, four bytes a pixel, the bottom row first, as textures have it.</summary>
        /// <param name="count">How many bytes of the array are the JPEG's.</param>
        /// <param name="pixels">The array for the pixels. Replaced by a longer array if it is too short.</param>
        /// <exception cref="JpegNotSupportedException">It is not a baseline JPEG of <see cref="MaxPixels"/> or less.
        /// </exception>
        /// <exception cref="JpegFormatException">It is damaged, or no JPEG. Nothing was written.</exception>
        public void Decode(byte[] jpeg, int count, ref byte[] pixels)
        {
            int at = _headers.Begin(jpeg, count);
            Array.Clear(_block, 0, _block.Length); // a damaged picture may have left it half full
            bool isFirst = true;
            do
            {
                at = _headers.ReadToScan(at);
                if (isFirst)
                {
                    MakeRoom(count);
                    isFirst = false;
                }
                _entropy.Begin(jpeg, at, count);
                ReadScan();
                at = IsWhole() ? count : _entropy.End();
            }
            while (at < count);
            if (!IsWhole())
            {
                throw new JpegFormatException("the data end before all components have come", count);
            }
            Write(ref pixels);
            Width = _headers.Width;
            Height = _headers.Height;
        }

        private void MakeRoom(int count)
        {
            int width = _headers.Width;
            int height = _headers.Height;
            if ((long)width * height > MaxPixels)
            {
                throw new JpegNotSupportedException(
                    width + " x " + height + " pixels, at most " + MaxPixels, _headers.SizeAt);
            }
            int unitsAcross = Units(width, 8 * _headers.Horizontal);
            int unitsDown = Units(height, 8 * _headers.Vertical);
            long blocks = 0;
            for (int i = 0; i < _headers.Count; i++)
            {
                JpegComponent component = _headers.Component(i);
                blocks += (long)Units(component.Width, 8) * Units(component.Height, 8);
            }
            if (blocks > (long)BlocksPerByte * count)
            {
                throw new JpegFormatException(
                    width + " x " + height + " pixels in " + count + " bytes, fewer than so many take",
                    _headers.SizeAt);
            }
            for (int i = 0; i < _headers.Count; i++)
            {
                JpegComponent component = _headers.Component(i);
                component.Stride = unitsAcross * component.Horizontal * 8;
                int samples = component.Stride * unitsDown * component.Vertical * 8;
                if (component.Plane.Length < samples)
                {
                    component.Plane = new byte[samples];
                }
            }
        }

        private void ReadScan()
        {
            int count = _headers.ScannedCount;
            JpegComponent alone = count == 1 ? _headers.Scanned(0) : null;
            int across = alone == null ? Units(_headers.Width, 8 * _headers.Horizontal) : Units(alone.Width, 8);
            int down = alone == null ? Units(_headers.Height, 8 * _headers.Vertical) : Units(alone.Height, 8);
            int untilRestart = _headers.RestartInterval;
            int restarts = 0;
            ForgetPredictions(count);
            for (int y = 0; y < down; y++)
            {
                for (int x = 0; x < across; x++)
                {
                    if (_headers.RestartInterval > 0 && untilRestart-- == 0)
                    {
                        _entropy.Restart(restarts++ & 7);
                        ForgetPredictions(count);
                        untilRestart = _headers.RestartInterval - 1;
                    }
                    if (alone != null)
                    {
                        ReadBlock(alone, x, y);
                        continue;
                    }
                    for (int i = 0; i < count; i++)
                    {
                        ReadUnit(_headers.Scanned(i), x, y);
                    }
                }
            }
        }

        private void ReadUnit(JpegComponent component, int x, int y)
        {
            for (int v = 0; v < component.Vertical; v++)
            {
                for (int h = 0; h < component.Horizontal; h++)
                {
                    ReadBlock(component, x * component.Horizontal + h, y * component.Vertical + v);
                }
            }
        }

        private void ReadBlock(JpegComponent component, int x, int y)
        {
            int[] block = _block;
            int at = 8 * (y * component.Stride + x);
            bool hasMore = _entropy.ReadBlock(
                component.Dc, component.Ac, component.Steps, ref component.Prediction, block);
            if (hasMore)
            {
                _transform.Write(block, component.Plane, at, component.Stride);
                Array.Clear(block, 0, block.Length);
            }
            else
            {
                InverseDct.WriteFlat(block[0], component.Plane, at, component.Stride);
            }
        }

        private void ForgetPredictions(int count)
        {
            for (int i = 0; i < count; i++)
            {
                _headers.Scanned(i).Prediction = 0;
            }
        }

        private bool IsWhole()
        {
            for (int i = 0; i < _headers.Count; i++)
            {
                if (!_headers.Component(i).IsRead)
                {
                    return false;
                }
            }
            return true;
        }

        private void Write(ref byte[] pixels)
        {
            int width = _headers.Width;
            int height = _headers.Height;
            if (pixels == null || pixels.Length < 4 * width * height)
            {
                pixels = new byte[4 * width * height];
            }
            int to = 4 * width * (height - 1);
            for (int row = 0; row < height; row++, to -= 4 * width)
            {
                byte[] one = _upsampling[0].Row(_headers.Component(0), row, out int first);
                if (_headers.Count == 1)
                {
                    ColourConversion.FromGrey(one, first, pixels, to, width);
                    continue;
                }
                int third;
                byte[] two = _upsampling[1].Row(_headers.Component(1), row, out int second);
                byte[] three = _upsampling[2].Row(_headers.Component(2), row, out third);
                if (_headers.IsRgb)
                {
                    ColourConversion.FromRgb(one, first, two, second, three, third, pixels, to, width);
                }
                else
                {
                    ColourConversion.FromYcc(one, first, two, second, three, third, pixels, to, width);
                }
            }
        }

        private static int Units(int length, int unit) => (length + unit - 1) / unit;
    }
}
