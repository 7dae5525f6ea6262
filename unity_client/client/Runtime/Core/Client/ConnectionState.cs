// SPDX-License-Identifier: Apache-2.0
namespace Ros2Gateway
{
    /// <summary>The state of a client's connection.</summary>
    public enum ConnectionState
    {
        /// <summary>Not connected, and not trying to be.</summary>
        Disconnected,

        /// <summary>An attempt is under way.</summary>
        Connecting,

        /// <summary>Frames flow.</summary>
        Connected,

        /// <summary>The connection was lost or could not be made. The next attempt comes by itself.</summary>
        Waiting,

        /// <summary>The gateway refuses this client (a wrong token, a role removed). Trying again does not help.</summary>
        Refused,
    }
}
