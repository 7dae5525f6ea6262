// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Diagnostics;
using System.Threading;

namespace Ros2Gateway.Pictures
{
    /// <summary>
    /// Decodes pictures on a thread of the pool, one at a time. Of several that wait only the newest.
    /// </summary>
    /// <remarks>
    /// Neither the thread that offers pictures waits for it (the one that reads frames, which other topics need)
    /// nor the one that takes them. Buffers are used again, at most four: of a picture that waits, is decoded, is
    /// ready, and was taken. So pictures of one size allocate nothing after that.
    /// </remarks>
    public sealed class BackgroundDecoder
    {
        private readonly object _gate = new();
        private readonly JpegDecoder _jpeg = new(); // of the thread that decodes, one at a time
        private readonly Stack<DecodedPicture> _free = new();
        private readonly WaitCallback _work;
        private DecodedPicture _waiting; // its compressed bytes alone
        private DecodedPicture _ready;
        private bool _isAtWork;

        /// <summary>Makes one that does nothing yet.</summary>
        public BackgroundDecoder() => _work = state => Work();

        /// <summary>How many pictures made room for newer ones, before they were decoded or after.</summary>
        public long Skipped { get; private set; }

        /// <summary>Takes a copy of a picture, to decode it soon. Any thread.</summary>
        /// <param name="compressed">JPEG, or another format, which is handed back as it is.</param>
        /// <param name="format">Handed back as well.</param>
        public void Offer(byte[] compressed, string format) =>
            Offer(compressed, compressed == null ? 0 : compressed.Length, format);

        /// <summary>Like the other, with a picture that is the first bytes of an array.</summary>
        public void Offer(byte[] compressed, int count, string format)
        {
            lock (_gate)
            {
                if (_waiting != null)
                {
                    Skipped++;
                }
                else
                {
                    _waiting = _free.Count > 0 ? _free.Pop() : new DecodedPicture();
                }
                _waiting.TakeCompressed(compressed, count, format);
                if (_isAtWork)
                {
                    return;
                }
                _isAtWork = true;
            }
            ThreadPool.UnsafeQueueUserWorkItem(_work, null);
        }

        /// <summary>Takes the newest picture that was decoded since the last call, or null. Any thread.</summary>
        /// <remarks>To be given back by <see cref="GiveBack"/>, for the next one.</remarks>
        public DecodedPicture Take()
        {
            lock (_gate)
            {
                DecodedPicture ready = _ready;
                _ready = null;
                return ready;
            }
        }

        /// <summary>Gives back what was taken.</summary>
        public void GiveBack(DecodedPicture picture)
        {
            lock (_gate)
            {
                _free.Push(picture);
            }
        }

        private void Work()
        {
            while (true)
            {
                DecodedPicture picture;
                lock (_gate)
                {
                    picture = _waiting;
                    _waiting = null;
                    if (picture == null)
                    {
                        _isAtWork = false;
                        return;
                    }
                }
                picture.Decode(_jpeg);
                lock (_gate)
                {
                    if (_ready != null)
                    {
                        Skipped++;
                        _free.Push(_ready);
                    }
                    _ready = picture;
                }
            }
        }
    }

    /// <summary>A picture of <see cref="BackgroundDecoder"/>: its pixels, or why they are missing.</summary>
    public sealed class DecodedPicture
    {
        private byte[] _compressed = Array.Empty<byte>();
        private int _compressedBytes;
        private byte[] _pixels = Array.Empty<byte>();
        private long _since;

        internal DecodedPicture()
        {
        }

        /// <summary>RGBA, the bottom row first. 4 * Width * Height bytes of it, there may be more.</summary>
        public byte[] Pixels => _pixels;

        /// <summary>In pixels. 0 if it was not decoded.</summary>
        public int Width { get; private set; }

        /// <summary>Like <see cref="Width"/>.</summary>
        public int Height { get; private set; }

        /// <summary>The format, by the message.</summary>
        public string Format { get; private set; }

        /// <summary>The error. Null if it was decoded, or <see cref="IsOther"/>.</summary>
        public string Error { get; private set; }

        /// <summary>Whether it is not a baseline JPEG: a PNG, or progressive. Unity's own decoder may know it.</summary>
        public bool IsOther { get; private set; }

        /// <summary>How long ago it was offered, in seconds.</summary>
        public double AgeSeconds => (Stopwatch.GetTimestamp() - _since) / (double)Stopwatch.Frequency;

        /// <summary>A copy of the bytes that were offered.</summary>
        public byte[] Compressed()
        {
            byte[] copy = new byte[_compressedBytes];
            Buffer.BlockCopy(_compressed, 0, copy, 0, _compressedBytes);
            return copy;
        }

        internal void TakeCompressed(byte[] compressed, int bytes, string format)
        {
            if (_compressed.Length < bytes)
            {
                _compressed = new byte[bytes + bytes / 4]; // the next one may be a little longer
            }
            if (bytes > 0)
            {
                Buffer.BlockCopy(compressed, 0, _compressed, 0, bytes);
            }
            _compressedBytes = bytes;
            _since = Stopwatch.GetTimestamp();
            Format = format;
        }

        internal void Decode(JpegDecoder decoder)
        {
            Width = 0;
            Height = 0;
            Error = null;
            IsOther = !JpegDecoder.IsJpeg(_compressed, _compressedBytes);
            if (IsOther)
            {
                return;
            }
            try
            {
                decoder.Decode(_compressed, _compressedBytes, ref _pixels);
                Width = decoder.Width;
                Height = decoder.Height;
            }
            catch (JpegNotSupportedException)
            {
                IsOther = true;
            }
            catch (JpegFormatException error)
            {
                Error = error.Message;
            }
            catch (OutOfMemoryException)
            {
                Error = "not enough memory for it";
            }
            catch (Exception error) // a fault of the decoder, which is not to end all pictures that come after
            {
                Error = "the decoder failed: " + error.GetType().Name + ": " + error.Message;
            }
        }
    }
}
