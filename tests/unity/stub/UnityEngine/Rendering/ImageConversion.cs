// SPDX-License-Identifier: Apache-2.0
using System;
using UnityEngine.Experimental.Rendering;
using UnityEngine.Stage;

namespace UnityEngine
{
    /// <summary>Reads no pixels, only how many there are, as tests need it.</summary>
    public static class ImageConversion
    {
        public static bool LoadImage(this Texture2D tex, byte[] data)
        {
            return LoadImage(tex, data, false);
        }

        public static bool LoadImage(this Texture2D tex, byte[] data, bool markNonReadable)
        {
            MainThread.Check("LoadImage");
            int width;
            int height;
            bool isPng = ImageHeader.ReadPng(data, out width, out height);
            if (!isPng && !ImageHeader.ReadJpeg(data, out width, out height))
            {
                return false;
            }
            tex.Take(width, height, isPng ? TextureFormat.ARGB32 : TextureFormat.RGB24);
            return true;
        }

        public static byte[] EncodeToJPG(this Texture2D tex)
        {
            return EncodeToJPG(tex, 75);
        }

        /// <summary>A gray JPEG of the texture's size, whatever it shows.</summary>
        public static byte[] EncodeToJPG(this Texture2D tex, int quality)
        {
            MainThread.Check("EncodeToJPG");
            return GrayJpeg.Of(tex.width, tex.height);
        }

        /// <summary>Like EncodeToJPG. Any thread.</summary>
        public static byte[] EncodeArrayToJPG(
            Array array, GraphicsFormat format, uint width, uint height, uint rowBytes = 0, int quality = 75)
        {
            if (array.Length < 4 * width * height)
            {
                throw new ArgumentException("array is too small for " + width + " x " + height);
            }
            return GrayJpeg.Of((int)width, (int)height);
        }
    }
}
