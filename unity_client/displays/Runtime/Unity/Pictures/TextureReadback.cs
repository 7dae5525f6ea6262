// SPDX-License-Identifier: Apache-2.0
using System;
using System.Threading;
using Unity.Collections;
using UnityEngine;
using UnityEngine.Experimental.Rendering;
using UnityEngine.Rendering;
using Object = UnityEngine.Object;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// Makes JPEGs of textures without waiting for the GPU, and encodes them on another thread: the main thread only
    /// copies pixels. One at a time. It uses its buffers again.
    /// </summary>
    internal sealed class TextureReadback
    {
        private const int BytesPerPixel = 4; // RGBA
        private const int MaxFailures = 5; // in a row: a device that is lost for a moment fails once or twice

        private readonly Action<AsyncGPUReadbackRequest> _onPixels;
        private readonly WaitCallback _encode;
        private RenderTexture _target;
        private byte[] _pixels = Array.Empty<byte>();
        private int _isBusy; // from Begin until the JPEG is made
        private int _width;
        private int _height;
        private int _quality;
        private int _failures; // in a row
        private Action<byte[]> _done;

        internal TextureReadback()
        {
            _onPixels = TakePixels;
            _encode = state => Encode();
        }

        /// <summary>Whether this GPU can: all but WebGL's, and OpenGL ES of old phones.</summary>
        internal static bool IsSupported => SystemInfo.supportsAsyncGPUReadback;

        /// <summary>Whether it has failed so often in a row that it should be tried no more.</summary>
        internal bool HasFailed => _failures >= MaxFailures;

        /// <summary>Lets it be tried again: the GPU may be back.</summary>
        internal void Retry() => _failures = 0;

        /// <summary>Whether a picture is under way, so that no other can be begun.</summary>
        internal bool IsBusy => Volatile.Read(ref _isBusy) == 1;

        /// <summary>Begins with a texture, scaled to a size. Nothing may be under way.</summary>
        /// <param name="done">Gets the JPEG, on another thread, some frames later. Null, on the main thread, if the GPU
        /// fails.</param>
        internal void Begin(Texture texture, int width, int height, int quality, Action<byte[]> done)
        {
            Volatile.Write(ref _isBusy, 1);
            _width = width;
            _height = height;
            _quality = quality;
            _done = done;
            if (_target == null || _target.width != width || _target.height != height)
            {
                Object.Destroy(_target);
                _target = new RenderTexture(width, height, 0);
            }
            Graphics.Blit(texture, _target);
            AsyncGPUReadback.Request(_target, 0, TextureFormat.RGBA32, _onPixels);
        }

        internal void Destroy() => Object.Destroy(_target);

        private void TakePixels(AsyncGPUReadbackRequest request)
        {
            if (request.hasError)
            {
                _failures++;
                Volatile.Write(ref _isBusy, 0); // the texture is gone, or the device: the next one is tried again
                _done(null);
                return;
            }
            _failures = 0;
            // valid in this frame alone
            NativeArray<byte> pixels = request.GetData<byte>();
            if (_pixels.Length != pixels.Length)
            {
                _pixels = new byte[pixels.Length];
            }
            pixels.CopyTo(_pixels);
            ThreadPool.UnsafeQueueUserWorkItem(_encode, null);
        }

        private void Encode()
        {
            try
            {
                byte[] jpeg = ImageConversion.EncodeArrayToJPG(
                    _pixels, GraphicsFormat.R8G8B8A8_SRGB, (uint)_width, (uint)_height,
                    (uint)(_width * BytesPerPixel), _quality);
                _done(jpeg);
            }
            catch (Exception error)
            {
                Debug.LogException(error); // nobody else would hear of it on this thread
            }
            Volatile.Write(ref _isBusy, 0);
        }
    }
}
