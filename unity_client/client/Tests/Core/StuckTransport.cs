// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Text;

namespace Ros2Gateway.Tests
{
    /// <summary>A network that takes one frame at a time, and no other until a test lets it go.</summary>
    public sealed class StuckTransport : ITransport
    {
        public readonly List<string> Sent = new();
        private ITransportListener _listener;
        private bool _isBusy;

        /// <summary>Whether frames leave at once.</summary>
        public bool IsFree { get; set; }

        public void Open(Uri address, ITransportListener listener)
        {
            _listener = listener;
            IsFree = true;
            _listener.OnOpen();
        }

        public bool TrySend(byte[] buffer, int count)
        {
            if (_isBusy)
            {
                return false;
            }
            Sent.Add(Encoding.UTF8.GetString(buffer, 0, count));
            if (IsFree)
            {
                _listener.OnSent();
            }
            else
            {
                _isBusy = true;
            }
            return true;
        }

        /// <summary>Lets all go.</summary>
        public void Release()
        {
            IsFree = true;
            _isBusy = false;
            _listener.OnSent();
        }

        /// <summary>A frame comes.</summary>
        public void Receive(string frame)
        {
            byte[] bytes = Encoding.UTF8.GetBytes(frame);
            _listener.OnFrame(bytes, bytes.Length);
        }

        public void Poll()
        {
        }

        public void Close(int code, string reason)
        {
        }

        public void Dispose()
        {
        }
    }
}
