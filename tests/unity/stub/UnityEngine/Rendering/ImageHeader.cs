// SPDX-License-Identifier: Apache-2.0
namespace UnityEngine.Stage
{
    /// <summary>The size of an image, from its first bytes.</summary>
    internal static class ImageHeader
    {
        private static readonly byte[] PngSignature = { 0x89, 0x50, 0x4E, 0x47, 0x0D, 0x0A, 0x1A, 0x0A };

        public static bool ReadPng(byte[] image, out int width, out int height)
        {
            width = height = 0;
            for (int i = 0; i < PngSignature.Length; i++)
            {
                if (image == null || image.Length < 24 || image[i] != PngSignature[i])
                {
                    return false;
                }
            }
            width = (BigEndian16(image, 16) << 16) | BigEndian16(image, 18);
            height = (BigEndian16(image, 20) << 16) | BigEndian16(image, 22);
            return true;
        }

        public static bool ReadJpeg(byte[] image, out int width, out int height)
        {
            width = height = 0;
            if (image == null || image.Length < 4 || image[0] != 0xFF || image[1] != 0xD8)
            {
                return false;
            }
            int at = 2;
            while (at + 9 <= image.Length && image[at] == 0xFF)
            {
                int marker = image[at + 1];
                bool isStartOfFrame = marker >= 0xC0 && marker <= 0xCF
                    && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
                if (isStartOfFrame)
                {
                    height = BigEndian16(image, at + 5);
                    width = BigEndian16(image, at + 7);
                    return true;
                }
                at += 2 + BigEndian16(image, at + 2);
            }
            return false;
        }

        private static int BigEndian16(byte[] bytes, int at)
        {
            return (bytes[at] << 8) | bytes[at + 1];
        }
    }
}
