// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Diagnostics;
using System.Threading;
using NUnit.Framework;

namespace Ros2Gateway.Tests
{
    /// <summary>A client under test, what it heard, and how to wait for something.</summary>
    internal sealed class Live : IDisposable
    {
        internal const int TimeoutMilliseconds = 120000; // a machine may be busy with other things

        /// <summary>The gateway with the simulated robot.</summary>
        internal const string Gateway = "ROS2GATEWAY_TEST_URL";

        /// <summary>A server that misbehaves, by path. "/through" leads to the gateway above.</summary>
        internal const string Rogue = "ROS2GATEWAY_ROGUE_URL";

        /// <summary>A port where nobody ever answers.</summary>
        internal const string Deaf = "ROS2GATEWAY_DEAF_URL";

        internal readonly GatewayClient Client;
        internal readonly List<GatewayEvent> Events = new List<GatewayEvent>();
        internal readonly List<ConnectionState> States = new List<ConnectionState>();

        internal Live(string where, string path = "", Action<GatewayOptions> change = null)
        {
            GatewayOptions options = new GatewayOptions { Address = Address(where) + path };
            if (change != null)
            {
                change(options);
            }
            Client = new GatewayClient(options);
            Client.EventHeard += Events.Add;
            Client.StateChanged += States.Add;
        }

        internal static string Address(string where)
        {
            string address = Environment.GetEnvironmentVariable(where);
            if (string.IsNullOrEmpty(address))
            {
                Assert.Ignore("needs a server: set " + where);
            }
            return address;
        }

        internal static Live Connected(string where = Gateway, string path = "", Action<GatewayOptions> change = null)
        {
            Live live = new Live(where, path, change);
            live.Client.Connect();
            live.Until(() => live.Client.IsConnected, "to be connected");
            return live;
        }

        /// <summary>Pumps until something holds.</summary>
        internal void Until(Func<bool> holds, string what)
        {
            Until(holds, what, () => Client.Pump());
        }

        /// <summary>Does something again and again until something holds.</summary>
        internal void Until(Func<bool> holds, string what, Action again)
        {
            Stopwatch watch = Stopwatch.StartNew();
            while (true)
            {
                again();
                if (holds())
                {
                    return;
                }
                if (watch.ElapsedMilliseconds > TimeoutMilliseconds)
                {
                    Assert.Fail("waited in vain " + what + "; heard: " + string.Join(" | ", Events));
                }
                Thread.Sleep(2);
            }
        }

        internal bool Heard(string words)
        {
            return Events.Exists(happened => happened.Text.Contains(words));
        }

        public void Dispose()
        {
            Client.Dispose();
        }
    }
}
