// SPDX-License-Identifier: Apache-2.0
using System;
using UnityEngine.Stage;

namespace UnityEngine
{
    public class Texture : Object
    {
        protected Texture()
        {
        }

        public virtual int width { get; set; }

        public virtual int height { get; set; }

        public FilterMode filterMode { get; set; }

        public TextureWrapMode wrapMode { get; set; }

        public virtual bool isReadable
        {
            get { return true; }
        }
    }

    public sealed class Texture2D : Texture
    {
        private Color32[] _pixels;

        public Texture2D(int width, int height)
            : this(width, height, TextureFormat.RGBA32, true)
        {
        }

        public Texture2D(int width, int height, TextureFormat textureFormat, bool mipChain)
        {
            MainThread.Check("Internal_CreateImpl");
            Resize(width, height);
            format = textureFormat;
        }

        public static Texture2D whiteTexture
        {
            get { return new Texture2D(4, 4); }
        }

        public TextureFormat format { get; private set; }

        internal Color32[] Pixels
        {
            get { return _pixels; }
        }

        public void Apply()
        {
            Apply(true, false);
        }

        public void Apply(bool updateMipmaps)
        {
            Apply(updateMipmaps, false);
        }

        public void Apply(bool updateMipmaps, bool makeNoLongerReadable)
        {
            MainThread.Check("ApplyImpl");
        }

        public Color GetPixel(int x, int y)
        {
            return _pixels[x + y * width];
        }

        public void SetPixel(int x, int y, Color color)
        {
            _pixels[x + y * width] = color;
        }

        public Color32[] GetPixels32()
        {
            MainThread.Check("GetPixels32");
            return (Color32[])_pixels.Clone();
        }

        public void SetPixels32(Color32[] colors)
        {
            MainThread.Check("SetPixels32");
            if (colors.Length != width * height)
            {
                throw new UnityException("SetPixels32 called with invalid number of pixels");
            }
            Array.Copy(colors, _pixels, colors.Length);
        }

        public void LoadRawTextureData(byte[] data)
        {
            MainThread.Check("LoadRawTextureDataImplArray");
            int bytesPerPixel = BytesPerPixel(format);
            if (data.Length < width * height * bytesPerPixel)
            {
                throw new UnityException("LoadRawTextureData: not enough data provided "
                    + "(will result in overread).");
            }
            for (int i = 0; i < _pixels.Length; i++)
            {
                int at = i * bytesPerPixel;
                byte alpha = bytesPerPixel == 4 ? data[at + 3] : (byte)255;
                _pixels[i] = bytesPerPixel == 1
                    ? new Color32(data[at], data[at], data[at], 255)
                    : new Color32(data[at], data[at + 1], data[at + 2], alpha);
            }
        }

        public bool Reinitialize(int width, int height)
        {
            MainThread.Check("ReinitializeImpl");
            Resize(width, height);
            return true;
        }

        public bool Reinitialize(int width, int height, TextureFormat format, bool hasMipMap)
        {
            Reinitialize(width, height);
            this.format = format;
            return true;
        }

        public void ReadPixels(Rect source, int destX, int destY)
        {
            MainThread.Check("ReadPixelsImpl");
        }

        internal void Take(int width, int height, TextureFormat newFormat)
        {
            Resize(width, height);
            format = newFormat;
        }

        private static int BytesPerPixel(TextureFormat format)
        {
            switch (format)
            {
                case TextureFormat.R8:
                case TextureFormat.Alpha8:
                    return 1;
                case TextureFormat.RGB24:
                    return 3;
                default:
                    return 4;
            }
        }

        private void Resize(int newWidth, int newHeight)
        {
            width = newWidth;
            height = newHeight;
            if (_pixels == null || _pixels.Length != newWidth * newHeight)
            {
                _pixels = new Color32[newWidth * newHeight];
            }
        }
    }

    public class RenderTexture : Texture
    {
        public RenderTexture(int width, int height, int depth)
        {
            this.width = width;
            this.height = height;
        }

        public override bool isReadable
        {
            get { return false; }
        }

        public static RenderTexture active { get; set; }

        public bool Create()
        {
            return true;
        }

        public void Release()
        {
        }

        public static RenderTexture GetTemporary(int width, int height, int depthBuffer)
        {
            return new RenderTexture(width, height, depthBuffer);
        }

        public static void ReleaseTemporary(RenderTexture temp)
        {
            DestroyImmediate(temp);
        }
    }

    public class Graphics
    {
        /// <summary>Copies nothing: there are no pixels on the GPU.</summary>
        public static void Blit(Texture source, RenderTexture dest)
        {
            MainThread.Check("Blit2");
        }
    }

    public enum TextureFormat
    {
        Alpha8 = 1,
        RGB24 = 3,
        RGBA32 = 4,
        ARGB32 = 5,
        BGRA32 = 14,
        R8 = 63,
    }

    public enum FilterMode
    {
        Point = 0,
        Bilinear = 1,
        Trilinear = 2,
    }

    public enum TextureWrapMode
    {
        Repeat = 0,
        Clamp = 1,
    }
}
