// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway.Pictures
{
    /// <summary>Makes rows of a component as wide as the picture.</summary>
    /// <remarks>
    /// If a sample stands for two, it counts three quarters and its neighbour one, each way: libjpeg's
    /// "fancy upsampling", to the last bit. Other ratios repeat samples.
    /// </remarks>
    internal sealed class Upsampling
    {
        private const int LeastFancyWidth = 3; // libjpeg repeats what is narrower

        private byte[] _row = Array.Empty<byte>();

        /// <summary>Finds a row of the picture in a component.</summary>
        /// <param name="at">Its start in the returned array. Samples for the picture's width follow.</param>
        internal byte[] Row(JpegComponent component, int row, out int at)
        {
            at = row / component.VerticalScale * component.Stride;
            if (component.HorizontalScale == 1 && component.VerticalScale == 1)
            {
                return component.Plane;
            }
            int room = component.Width * component.HorizontalScale;
            if (_row.Length < room)
            {
                _row = new byte[room];
            }
            if (component.HorizontalScale == 1 && component.VerticalScale == 2)
            {
                Between(component, row, at);
            }
            else if (component.HorizontalScale == 2 && component.VerticalScale <= 2
                && component.Width >= LeastFancyWidth)
            {
                if (component.VerticalScale == 1)
                {
                    Widen(component.Plane, at, component.Width);
                }
                else
                {
                    WidenBetween(component, row, at);
                }
            }
            else
            {
                Repeat(component, at);
            }
            at = 0;
            return _row;
        }

        private void Repeat(JpegComponent component, int at)
        {
            byte[] row = _row;
            int to = 0;
            for (int i = 0; i < component.Width; i++)
            {
                byte sample = component.Plane[at + i];
                for (int j = 0; j < component.HorizontalScale; j++)
                {
                    row[to++] = sample;
                }
            }
        }

        private void Widen(byte[] plane, int at, int width)
        {
            byte[] row = _row;
            int before;
            int sample = plane[at];
            int after = plane[at + 1];
            row[0] = (byte)sample;
            row[1] = (byte)((3 * sample + after + 2) >> 2);
            for (int i = 1; i < width - 1; i++)
            {
                before = sample;
                sample = after;
                after = plane[at + i + 1];
                row[2 * i] = (byte)((3 * sample + before + 1) >> 2);
                row[2 * i + 1] = (byte)((3 * sample + after + 2) >> 2);
            }
            row[2 * width - 2] = (byte)((3 * after + sample + 1) >> 2);
            row[2 * width - 1] = (byte)after;
        }

        // Half way down to the next row of samples, or up to the one before.
        private void Between(JpegComponent component, int row, int at)
        {
            byte[] plane = component.Plane;
            int other = Neighbour(component, row) * component.Stride;
            int round = row % 2 == 0 ? 1 : 2;
            for (int i = 0; i < component.Width; i++)
            {
                _row[i] = (byte)((3 * plane[at + i] + plane[other + i] + round) >> 2);
            }
        }

        private void WidenBetween(JpegComponent component, int row, int at)
        {
            byte[] plane = component.Plane;
            byte[] to = _row;
            int width = component.Width;
            int other = Neighbour(component, row) * component.Stride;
            int before;
            int sum = 3 * plane[at] + plane[other];
            int after = 3 * plane[at + 1] + plane[other + 1];
            to[0] = (byte)((4 * sum + 8) >> 4);
            to[1] = (byte)((3 * sum + after + 7) >> 4);
            for (int i = 1; i < width - 1; i++)
            {
                before = sum;
                sum = after;
                after = 3 * plane[at + i + 1] + plane[other + i + 1];
                to[2 * i] = (byte)((3 * sum + before + 8) >> 4);
                to[2 * i + 1] = (byte)((3 * sum + after + 7) >> 4);
            }
            to[2 * width - 2] = (byte)((3 * after + sum + 8) >> 4);
            to[2 * width - 1] = (byte)((4 * after + 7) >> 4);
        }

        private static int Neighbour(JpegComponent component, int row)
        {
            int nearest = row / 2;
            int other = row % 2 == 0 ? nearest - 1 : nearest + 1;
            return Math.Min(Math.Max(other, 0), component.Height - 1);
        }
    }
}
