// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway
{
    /// <summary>The address of the gateway, and how long the client waits for it.</summary>
    public sealed class GatewayOptions
    {
        /// <summary>ws://HOST:PORT, or wss://. 9090 is the gateway's default port.</summary>
        public string Address = "ws://localhost:9090";

        /// <summary>Sent as the first frame, if there is one. Never part of the address or of any log.</summary>
        public string Token = "";

        /// <summary>How long connecting may take, in milliseconds.</summary>
        public int ConnectMilliseconds = 5000;

        /// <summary>How often the gateway is pinged, in milliseconds. Also how often clocks are compared.</summary>
        public int HeartbeatMilliseconds = 2000;

        /// <summary>Without any frame for this long the connection counts as dead: three heartbeats.</summary>
        public int SilenceMilliseconds = 6000;

        /// <summary>The pause before the first new attempt, in milliseconds. It doubles with each that fails.</summary>
        public int FirstPauseMilliseconds = 500;

        /// <summary>The longest pause between two attempts, in milliseconds.</summary>
        public int LongestPauseMilliseconds = 2000;

        /// <summary>
        /// While a ping is unanswered for longer than this, in milliseconds, publishers refuse to send. It
        /// bounds what a stalled network delivers late: so many milliseconds' worth of commands.
        /// </summary>
        public int FreshMilliseconds = 500;

        /// <summary>
        /// How long a service may take to answer, in milliseconds, where a call says nothing else.
        /// </summary>
        public int CallMilliseconds = 10000;

        /// <summary>The longest message that is read. Longer ones become an event. A 4K picture takes 4 MB.</summary>
        public int MaxMessageBytes = 16 * 1024 * 1024;

        /// <summary>Makes the transport of each attempt. Null for <see cref="WebSocketTransport"/>.</summary>
        public Func<GatewayOptions, ITransport> Transport;

        /// <summary>
        /// Whether timeouts and heartbeats are kept in the background. False where there are no threads
        /// (WebGL): then <see cref="GatewayClient.Pump"/> keeps them.
        /// </summary>
        public bool UsesThreads = true;

        // So long a scene may take to load before it pumps for the first time.
        internal int UnpumpedMilliseconds = 10000;

        internal ITransport NewTransport() =>
            Transport != null ? Transport(this) : new WebSocketTransport(ConnectMilliseconds, MaxMessageBytes);
    }
}
