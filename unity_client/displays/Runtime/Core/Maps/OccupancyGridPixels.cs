// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Messages.NavMsgs;

namespace Ros2Gateway.Maps
{
    /// <summary>The look of the cells of a grid.</summary>
    public enum OccupancyGridColors
    {
        /// <summary>A map on paper: free is white, occupied black, unknown a greenish grey.</summary>
        Map,

        /// <summary>Costs over a map: free is clear, then blue to red. Obstacles are purple and cyan.</summary>
        Costmap,
    }

    /// <summary>A grid as the pixels of a texture: four bytes each, the first row at the grid's origin.</summary>
    public sealed class OccupancyGridPixels
    {
        /// <summary>A texture of more pixels a side is beyond what phones and headsets take.</summary>
        public const int MaxSide = 4096;

        private readonly byte[] _palette = new byte[4 * 256];
        private byte[] _pixels = new byte[0];

        /// <summary>Pixels of a look.</summary>
        public OccupancyGridPixels(OccupancyGridColors colors)
        {
            for (int value = 0; value < 256; value++)
            {
                Color((sbyte)value, colors, 4 * value);
            }
        }

        /// <summary>Pixels a row.</summary>
        public int Width { get; private set; }

        /// <summary>Rows.</summary>
        public int Height { get; private set; }

        /// <summary>How many cells a side share a pixel: 1, except for grids of more than <see cref="MaxSide"/>.</summary>
        public int CellsPerPixel { get; private set; }

        /// <summary>Red, green, blue and alpha of each pixel. Of exactly the size, and used again.</summary>
        public byte[] Pixels => _pixels;

        /// <summary>Draws a grid. Returns what is wrong with it, or null.</summary>
        public string Draw(OccupancyGridMsg grid)
        {
            string problem = ProblemOf(grid);
            if (problem != null)
            {
                return problem;
            }
            int width = (int)grid.info.width, height = (int)grid.info.height;
            CellsPerPixel = (Math.Max(width, height) - 1) / MaxSide + 1;
            Width = (width - 1) / CellsPerPixel + 1;
            Height = (height - 1) / CellsPerPixel + 1;
            if (_pixels.Length != 4 * Width * Height)
            {
                _pixels = new byte[4 * Width * Height];
            }
            for (int y = 0; y < Height; y++)
            {
                for (int x = 0; x < Width; x++)
                {
                    int from = 4 * (byte)Cell(grid.data, width, height, x * CellsPerPixel, y * CellsPerPixel);
                    int to = 4 * (y * Width + x);
                    _pixels[to] = _palette[from];
                    _pixels[to + 1] = _palette[from + 1];
                    _pixels[to + 2] = _palette[from + 2];
                    _pixels[to + 3] = _palette[from + 3];
                }
            }
            return null;
        }

        /// <summary>The fault of a grid, or null.</summary>
        public static string ProblemOf(OccupancyGridMsg grid)
        {
            if (grid.info == null || grid.data == null)
            {
                return "the grid has no info or no data";
            }
            ulong cells = (ulong)grid.info.width * grid.info.height;
            if (cells == 0)
            {
                return "the grid has no cells: " + grid.info.width + " by " + grid.info.height;
            }
            if (cells != (ulong)grid.data.Length)
            {
                return "the grid's data have " + grid.data.Length + " cells, must have " + grid.info.width + " by "
                    + grid.info.height;
            }
            float resolution = grid.info.resolution;
            if (!(resolution > 0) || float.IsInfinity(resolution))
            {
                return "the grid's resolution is not above 0 m a cell";
            }
            return null;
        }

        // Of cells that share a pixel the one that matters most to a robot: thin walls must not vanish.
        private sbyte Cell(sbyte[] cells, int width, int height, int left, int bottom)
        {
            sbyte most = cells[bottom * width + left];
            int right = Math.Min(left + CellsPerPixel, width), top = Math.Min(bottom + CellsPerPixel, height);
            for (int y = bottom; y < top; y++)
            {
                for (int x = left; x < right; x++)
                {
                    most = Math.Max(most, cells[y * width + x]);
                }
            }
            return most;
        }

        private void Color(sbyte value, OccupancyGridColors colors, int at)
        {
            bool isCost = colors == OccupancyGridColors.Costmap;
            if (value < 0)
            {
                Set(at, 112, 137, 134, isCost ? (byte)0 : (byte)255); // -1, and what has no meaning
            }
            else if (value > 100)
            {
                Set(at, 0, 160, 0, 255); // has no meaning either, and should be seen
            }
            else if (!isCost)
            {
                byte grey = (byte)(255 - 255 * value / 100);
                Set(at, grey, grey, grey, 255);
            }
            else if (value >= 99)
            {
                Set(at, value == 100 ? (byte)255 : (byte)0, value == 100 ? (byte)0 : (byte)255, 255, 200);
            }
            else
            {
                byte red = (byte)(255 * value / 98);
                Set(at, red, 0, (byte)(255 - red), value == 0 ? (byte)0 : (byte)160);
            }
        }

        private void Set(int at, byte r, byte g, byte b, byte a)
        {
            _palette[at] = r;
            _palette[at + 1] = g;
            _palette[at + 2] = b;
            _palette[at + 3] = a;
        }
    }
}
