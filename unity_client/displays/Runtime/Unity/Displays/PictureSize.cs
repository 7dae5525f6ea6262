// SPDX-License-Identifier: Apache-2.0
namespace Ros2Gateway.Unity
{
    /// <summary>
    /// Width and height of a JPEG (ISO/IEC 10918-1, annex B) or PNG (RFC 2083), without decoding it.
    /// </summary>
    internal static class PictureSize
    {
        private const int StartOfImage = 0xFFD8;
        private const ulong PngSignature = 0x89504E470D0A1A0A;
        private const int PngHeader = 24; // bytes: signature, length and name of IHDR, width, height

        /// <summary>Reads them. False if this is neither.</summary>
        internal static bool TryRead(byte[] picture, out int width, out int height)
        {
            width = height = 0;
            if (picture.Length >= PngHeader && Signature(picture) == PngSignature)
            {
                uint wide = Word(picture, 16), high = Word(picture, 20);
                width = wide > int.MaxValue ? int.MaxValue : (int)wide;
                height = high > int.MaxValue ? int.MaxValue : (int)high;
                return width > 0 && height > 0;
            }
            return picture.Length >= 4 && Half(picture, 0) == StartOfImage
                && TryReadJpeg(picture, out width, out height);
        }

        private static bool TryReadJpeg(byte[] picture, out int width, out int height)
        {
            width = height = 0;
            int at = 2;
            while (at + 9 <= picture.Length && picture[at] == 0xFF)
            {
                int marker = picture[at + 1];
                if (marker == 0xFF) // fill byte
                {
                    at++;
                    continue;
                }
                if (IsStartOfFrame(marker))
                {
                    height = Half(picture, at + 5);
                    width = Half(picture, at + 7);
                    return width > 0 && height > 0;
                }
                int length = Half(picture, at + 2);
                if (length < 2)
                {
                    return false;
                }
                at += 2 + length;
            }
            return false;
        }

        private static bool IsStartOfFrame(int marker)
        {
            bool isTable = marker == 0xC4 || marker == 0xC8 || marker == 0xCC;
            return marker >= 0xC0 && marker <= 0xCF && !isTable;
        }

        private static ulong Signature(byte[] png) => ((ulong)Word(png, 0) << 32) | Word(png, 4);

        private static int Half(byte[] bytes, int at) => (bytes[at] << 8) | bytes[at + 1];

        private static uint Word(byte[] bytes, int at) => ((uint)Half(bytes, at) << 16) | (uint)Half(bytes, at + 2);
    }
}
