// SPDX-License-Identifier: Apache-2.0
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>Makes JPEGs of textures, scaled down to fit. It uses its buffers again.</summary>
    internal sealed class TextureEncoder
    {
        private Texture2D _scaled;

        /// <summary>Encodes a texture. Null if it has no pixels.</summary>
        /// <param name="maxWidth">In pixels. 0 for no bound.</param>
        /// <param name="maxHeight">In pixels. 0 for no bound.</param>
        internal byte[] Encode(Texture texture, int maxWidth, int maxHeight, int quality)
        {
            if (!HasPixels(texture))
            {
                return null;
            }
            bool isWhole = Fit(texture, maxWidth, maxHeight, out int width, out int height);
            Texture2D plain = texture as Texture2D;
            bool isAsItShouldBe = plain != null && isWhole && plain.isReadable
                && (plain.format == TextureFormat.RGB24 || plain.format == TextureFormat.RGBA32);
            return (isAsItShouldBe ? plain : Scale(texture, width, height)).EncodeToJPG(quality);
        }

        internal static bool HasPixels(Texture texture) => texture != null && texture.width > 0 && texture.height > 0;

        /// <summary>Finds the size in which a texture fits. True if that is its own.</summary>
        internal static bool Fit(Texture texture, int maxWidth, int maxHeight, out int width, out int height)
        {
            float scale = Mathf.Min(Share(maxWidth, texture.width), Share(maxHeight, texture.height));
            width = Mathf.Max(1, Mathf.RoundToInt(texture.width * scale));
            height = Mathf.Max(1, Mathf.RoundToInt(texture.height * scale));
            return scale >= 1;
        }

        internal void Destroy() => Object.Destroy(_scaled);

        private static float Share(int bound, int size) => bound > 0 && bound < size ? (float)bound / size : 1;

        private Texture2D Scale(Texture texture, int width, int height)
        {
            if (_scaled == null)
            {
                _scaled = new Texture2D(width, height, TextureFormat.RGB24, false);
            }
            else if (_scaled.width != width || _scaled.height != height)
            {
                _scaled.Reinitialize(width, height);
            }
            RenderTexture before = RenderTexture.active;
            RenderTexture target = RenderTexture.GetTemporary(width, height, 0);
            Graphics.Blit(texture, target);
            RenderTexture.active = target;
            _scaled.ReadPixels(new Rect(0, 0, width, height), 0, 0);
            RenderTexture.active = before;
            RenderTexture.ReleaseTemporary(target);
            return _scaled;
        }
    }
}
