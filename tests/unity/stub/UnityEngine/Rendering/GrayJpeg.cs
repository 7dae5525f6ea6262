// SPDX-License-Identifier: Apache-2.0
using System.IO;

namespace UnityEngine.Stage
{
    /// <summary>The shortest valid baseline JPEG of a size: every block has the same gray.</summary>
    internal static class GrayJpeg
    {
        public static byte[] Of(int width, int height)
        {
            var jpeg = new MemoryStream();
            Write(jpeg, 0xFF, 0xD8, 0xFF, 0xDB, 0, 67, 0);
            for (int i = 0; i < 64; i++)
            {
                Write(jpeg, 1);
            }
            Write(jpeg, 0xFF, 0xC0, 0, 11, 8, height >> 8, height & 255, width >> 8, width & 255);
            Write(jpeg, 1, 1, 0x11, 0);
            WriteTable(jpeg, 0x00);
            WriteTable(jpeg, 0x10);
            Write(jpeg, 0xFF, 0xDA, 0, 8, 1, 1, 0, 0, 63, 0);
            // a block is two zero bits: no difference in brightness, end of block
            int bits = (width + 7) / 8 * ((height + 7) / 8) * 2;
            for (int i = 0; i < bits / 8; i++)
            {
                Write(jpeg, 0);
            }
            if (bits % 8 != 0)
            {
                Write(jpeg, 0xFF >> (bits % 8));
            }
            Write(jpeg, 0xFF, 0xD9);
            return jpeg.ToArray();
        }

        /// <summary>A Huffman table with one code, a single zero bit, for the symbol 0.</summary>
        private static void WriteTable(Stream jpeg, int identifier)
        {
            Write(jpeg, 0xFF, 0xC4, 0, 20, identifier, 1);
            for (int i = 0; i < 16; i++)
            {
                Write(jpeg, 0);
            }
        }

        private static void Write(Stream jpeg, params int[] bytes)
        {
            foreach (int value in bytes)
            {
                jpeg.WriteByte((byte)value);
            }
        }
    }
}
