// SPDX-License-Identifier: Apache-2.0
#if UNITY_WEBGL && !UNITY_EDITOR
using System;
using System.Text;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// The transport of WebGL builds, over the browser's WebSocket. There are no threads: the listener is
    /// called from within <see cref="Poll"/> only, in Unity's Update.
    /// </summary>
    /// <remarks>
    /// While the page is hidden the browser does not run Update, and frames pile up in the page. Beyond 64
    /// MiB it closes the connection with code 4000, "page does not read": frames cannot be dropped unread,
    /// and a new connection begins with the newest of every topic. A browser does not tell why it cannot
    /// connect.
    /// </remarks>
    public sealed class WebGlTransport : ITransport
    {
        private const int InboxBytes = 64 * 1024 * 1024; // four of the largest messages, 20 s of a camera
        private const int PollBytes = 1024 * 1024; // about 8 ms to parse, half a frame of the player's time
        private const int SendBytes = 256 * 1024; // for the browser to hold: more would only be late
        private const int FirstBufferBytes = 64 * 1024; // most frames. Larger ones make it grow
        private const int RetainedBufferBytes = 1024 * 1024; // the buffer of one rare huge frame is given back,
        private const int FramesUntilRare = 1000; // once so many were smaller: a cloud at 1 Hz next to what a robot says
        private const int ReasonBytes = 512; // a close frame's 123, or the browser's words

        private readonly int _maxMessageBytes;
        private byte[] _buffer = new byte[FirstBufferBytes];
        private ITransportListener _listener;
        private int _handle;
        private bool _isOpen;
        private bool _isSending;
        private int _smallerFrames; // since the last that would not fit in what is kept

        /// <param name="maxMessageBytes">Longer messages are thrown away.</param>
        public WebGlTransport(int maxMessageBytes)
        {
            _maxMessageBytes = maxMessageBytes;
        }

        /// <inheritdoc/>
        public void Open(Uri address, ITransportListener listener)
        {
            _listener = listener;
            byte[] url = Encoding.UTF8.GetBytes(address.AbsoluteUri);
            _handle = WebGlSocket.Connect(url, url.Length, _maxMessageBytes, InboxBytes);
        }

        /// <inheritdoc/>
        public bool TrySend(byte[] buffer, int count)
        {
            if (_handle == 0 || !_isOpen || _isSending || WebGlSocket.BufferedBytes(_handle) > SendBytes)
            {
                return false;
            }
            _isSending = WebGlSocket.Send(_handle, buffer, count) == 1;
            bool isTaken = _isSending;
            TellSent(); // the browser has it: a page that is hidden now has no later moment for what comes next
            return isTaken;
        }

        /// <inheritdoc/>
        public void Poll()
        {
            if (_handle == 0)
            {
                return;
            }
            // First the state: what came before the end is still told before it.
            int state = WebGlSocket.State(_handle);
            if (!_isOpen && (state == WebGlSocket.Open || WebGlSocket.FrameBytes(_handle) >= 0))
            {
                _isOpen = true;
                _listener.OnOpen();
            }
            if (_isOpen)
            {
                TellSent();
                Receive();
            }
            if (_handle != 0 && state == WebGlSocket.Closed && WebGlSocket.FrameBytes(_handle) < 0)
            {
                End();
            }
        }

        /// <inheritdoc/>
        public void Close(int code, string reason)
        {
            if (_handle != 0)
            {
                byte[] text = Encoding.UTF8.GetBytes(reason ?? "");
                WebGlSocket.Close(_handle, code, text, text.Length);
            }
        }

        /// <summary>Ends everything at once. The listener hears nothing more.</summary>
        public void Dispose()
        {
            if (_handle != 0)
            {
                WebGlSocket.Free(_handle);
                _handle = 0;
            }
        }

        private void TellSent()
        {
            // The listener may send the next one at once: as many as the browser takes.
            while (_handle != 0 && _isSending && WebGlSocket.BufferedBytes(_handle) <= SendBytes)
            {
                _isSending = false;
                _listener.OnSent();
            }
        }

        private void Receive()
        {
            int left = PollBytes;
            while (_handle != 0 && left > 0)
            {
                int size = WebGlSocket.FrameBytes(_handle);
                if (size < 0)
                {
                    return;
                }
                if (size <= _maxMessageBytes && size > _buffer.Length)
                {
                    _buffer = new byte[Math.Min(Math.Max(size, 2L * _buffer.Length), _maxMessageBytes)];
                }
                int count = WebGlSocket.Receive(_handle, _buffer, _buffer.Length);
                if (size > _maxMessageBytes)
                {
                    _listener.OnOversized(size);
                }
                else
                {
                    _listener.OnFrame(_buffer, count);
                }
                left -= size;
                _smallerFrames = size > RetainedBufferBytes ? 0 : _smallerFrames + 1;
            }
            if (_buffer.Length > RetainedBufferBytes && _smallerFrames >= FramesUntilRare)
            {
                _buffer = new byte[FirstBufferBytes];
            }
        }

        private void End()
        {
            var text = new byte[ReasonBytes];
            int code = WebGlSocket.CloseCode(_handle);
            int count = WebGlSocket.CloseReason(_handle, text, text.Length);
            string reason = Encoding.UTF8.GetString(text, 0, count);
            Dispose();
            _listener.OnClosed(code, reason);
        }
    }
}
#endif
