// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway
{
    /// <summary>One attempt to connect and, if it succeeds, the connection. Used once.</summary>
    /// <remarks>
    /// With threads the listener is called from background ones. Without threads
    /// (WebGL) from within <see cref="Poll"/>, <see cref="TrySend"/> and <see cref="Close"/>.
    /// </remarks>
    public interface ITransport : IDisposable
    {
        /// <summary>Begins to connect and returns at once. The listener is told about the network.</summary>
        void Open(Uri address, ITransportListener listener);

        /// <summary>Sends one text frame, or returns false: not open, or the last one is still under way.</summary>
        /// <remarks>
        /// The bytes must stay as they are until <see cref="ITransportListener.OnSent"/>, which may come
        /// before this returns. After false, try again after OnSent or a later <see cref="Poll"/>.
        /// </remarks>
        bool TrySend(byte[] buffer, int count);

        /// <summary>Does what is to be done where there are no threads, elsewhere nothing.</summary>
        void Poll();

        /// <summary>Says goodbye and closes, within a second. OnClosed follows. May be called in any state.</summary>
        void Close(int code, string reason);
    }

    /// <summary>The events of a transport. All but OnSent never overlap. Nothing comes after OnClosed.</summary>
    public interface ITransportListener
    {
        /// <summary>The connection stands.</summary>
        void OnOpen();

        /// <summary>Part of a message has come, and the rest is on its way.</summary>
        void OnProgress();

        /// <summary>One whole message. The buffer is the listener's until it returns.</summary>
        void OnFrame(byte[] buffer, int count);

        /// <summary>A message of more bytes than the transport takes was thrown away.</summary>
        void OnOversized(long bytes);

        /// <summary>The frame of the last TrySend has left, and its buffer is free.</summary>
        void OnSent();

        /// <summary>The end, exactly once, however it came. Code 0 where the peer gave none.</summary>
        void OnClosed(int code, string reason);
    }
}
