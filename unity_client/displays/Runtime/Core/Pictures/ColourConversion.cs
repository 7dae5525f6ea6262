// SPDX-License-Identifier: Apache-2.0
namespace Ros2Gateway.Pictures
{
    /// <summary>Makes rows of RGBA, opaque, of rows of components. With libjpeg's rounding.</summary>
    internal static class ColourConversion
    {
        private const int Below = 256; // more than a colour gets below 0 or, further up, above 255
        private const int Half = 1 << 15;

        // ITU-T T.871 (JFIF), clause 7, times 2^16
        private static readonly int[] CrToRed = Scaled(91881, Half, 16);
        private static readonly int[] CbToBlue = Scaled(116130, Half, 16);
        private static readonly int[] CrToGreen = Scaled(-46802, 0, 0);
        private static readonly int[] CbToGreen = Scaled(-22554, Half, 0);
        private static readonly byte[] Limited = MakeLimited();

        internal static void FromGrey(byte[] grey, int from, byte[] pixels, int to, int width)
        {
            for (int i = 0; i < width; i++, to += 4)
            {
                byte value = grey[from + i];
                pixels[to] = value;
                pixels[to + 1] = value;
                pixels[to + 2] = value;
                pixels[to + 3] = 255;
            }
        }

        internal static void FromRgb(
            byte[] red, int redFrom, byte[] green, int greenFrom, byte[] blue, int blueFrom,
            byte[] pixels, int to, int width)
        {
            for (int i = 0; i < width; i++, to += 4)
            {
                pixels[to] = red[redFrom + i];
                pixels[to + 1] = green[greenFrom + i];
                pixels[to + 2] = blue[blueFrom + i];
                pixels[to + 3] = 255;
            }
        }

        internal static void FromYcc(
            byte[] y, int yFrom, byte[] cb, int cbFrom, byte[] cr, int crFrom, byte[] pixels, int to, int width)
        {
            byte[] limited = Limited;
            int[] crToRed = CrToRed;
            int[] cbToBlue = CbToBlue;
            int[] crToGreen = CrToGreen;
            int[] cbToGreen = CbToGreen;
            for (int i = 0; i < width; i++, to += 4)
            {
                int bright = y[yFrom + i] + Below;
                int blue = cb[cbFrom + i];
                int red = cr[crFrom + i];
                pixels[to + 3] = 255;
                pixels[to + 2] = limited[bright + cbToBlue[blue]];
                pixels[to + 1] = limited[bright + ((cbToGreen[blue] + crToGreen[red]) >> 16)];
                pixels[to] = limited[bright + crToRed[red]];
            }
        }

        private static int[] Scaled(int factor, int round, int shift)
        {
            var scaled = new int[256];
            for (int i = 0; i < scaled.Length; i++)
            {
                scaled[i] = (factor * (i - 128) + round) >> shift;
            }
            return scaled;
        }

        private static byte[] MakeLimited()
        {
            var limited = new byte[3 * Below];
            for (int i = 0; i < limited.Length; i++)
            {
                int value = i - Below;
                limited[i] = value < 0 ? (byte)0 : value > 255 ? (byte)255 : (byte)value;
            }
            return limited;
        }
    }
}
