// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Unity;

namespace Ros2Gateway.Editor
{
    /// <summary>
    /// The editor's own client, outside play mode: its owner pumps it from the editor's update,
    /// and disposes it with the window that needed it. It says in words what it is waiting for.
    /// </summary>
    public sealed class EditorClient : IDisposable
    {
        private string _lastError = "";

        /// <summary>Begins to connect, to where these options say.</summary>
        public EditorClient(GatewayOptions options)
        {
            Address = options.Address;
            Client = new GatewayClient(options);
            Client.EventHeard += Hear;
            Client.Connect();
        }

        /// <summary>The client itself.</summary>
        public GatewayClient Client { get; private set; }

        /// <summary>The address that it connects to.</summary>
        public string Address { get; private set; }

        /// <summary>Why there is no connection, or that it is being made. Empty while there is one.</summary>
        public string Problem
        {
            get
            {
                if (Client.IsConnected)
                {
                    return "";
                }
                return _lastError.Length > 0 ? _lastError : "connecting to " + Address;
            }
        }

        /// <summary>The options of a connection of the scene. Without one, the defaults.</summary>
        public static GatewayOptions OptionsOf(GatewayConnection connection) =>
            connection != null ? connection.Options() : new GatewayOptions();

        /// <summary>Calls what waits. From the editor's update.</summary>
        public void Pump() => Client.Pump();

        /// <summary>Disconnects, for good.</summary>
        public void Dispose() => Client.Dispose();

        private void Hear(GatewayEvent happened)
        {
            if (happened.Level != EventLevel.Info)
            {
                _lastError = happened.Text;
            }
        }
    }
}
