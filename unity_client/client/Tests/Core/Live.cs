// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Diagnostics;
using System.Threading;
using NUnit.Framework;

namespace Ros2Gateway.Tests
{
    /// <summary>A client under test, what it heard, and how to wait for something.</summary>
    public sealed class Live : IDisposable
    {
        public const int TimeoutMilliseconds = 120000; // a machine may be busy with other things

        /// <summary>The gateway with the simulated robot.</summary>
        public const string Gateway = "ROS2GATEWAY_TEST_URL";

        /// <summary>A gateway that plays the recording of the simulated robot.</summary>
        public const string Recording = "ROS2GATEWAY_RECORDING_URL";

        /// <summary>A server that misbehaves, by path. "/through" leads to the gateway above.</summary>
        public const string Rogue = "ROS2GATEWAY_ROGUE_URL";

        /// <summary>A port where nobody ever answers.</summary>
        public const string Deaf = "ROS2GATEWAY_DEAF_URL";

        public readonly GatewayClient Client;
        public readonly List<GatewayEvent> Events = new();
        public readonly List<ConnectionState> States = new();

        public Live(string where, string path = "", Action<GatewayOptions> change = null)
        {
            GatewayOptions options = new() { Address = Address(where) + path };
            if (change != null)
            {
                change(options);
            }
            Client = new GatewayClient(options);
            Client.EventHeard += Events.Add;
            Client.StateChanged += States.Add;
        }

        public static string Address(string where)
        {
            string address = Environment.GetEnvironmentVariable(where);
            if (string.IsNullOrEmpty(address))
            {
                Assert.Ignore("needs a server: set " + where);
            }
            return address;
        }

        public static Live Connected(string where = Gateway, string path = "", Action<GatewayOptions> change = null)
        {
            Live live = new(where, path, change);
            live.Client.Connect();
            live.Until(() => live.Client.IsConnected, "to be connected");
            return live;
        }

        /// <summary>Pumps until something holds.</summary>
        public void Until(Func<bool> holds, string what) => Until(holds, what, () => Client.Pump());

        /// <summary>Does something again and again until something holds.</summary>
        public void Until(Func<bool> holds, string what, Action again)
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

        public bool Heard(string words) => Events.Exists(happened => happened.Text.Contains(words));

        public void Dispose() => Client.Dispose();
    }
}
