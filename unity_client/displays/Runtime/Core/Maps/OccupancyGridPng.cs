// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Pictures;

namespace Ros2Gateway.Maps
{
    /// <summary>The cells of a grid that comes as a PNG, which takes a small part of the array's size.</summary>
    public static class OccupancyGridPng
    {
        /// <summary>Asks the gateway for a PNG, and unpacks it.</summary>
        public static void Ask(SubscribeOptions options)
        {
            options.Image = new ImageOptions { Format = "png" };
            options.PackedInt8s = Cells;
        }

        /// <summary>Returns the cells. Any thread.</summary>
        /// <exception cref="FormatException">It is not such a PNG.</exception>
        public static sbyte[] Cells(byte[] png)
        {
            GreyPng reader = new(1); // maps come seldom: its buffers need not stay
            string problem = reader.Read(png);
            if (problem != null)
            {
                throw new FormatException(problem);
            }
            sbyte[] cells = new sbyte[reader.Width * reader.Height];
            Buffer.BlockCopy(reader.Pixels, 0, cells, 0, cells.Length);
            return cells;
        }
    }
}
