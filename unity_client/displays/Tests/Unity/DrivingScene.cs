// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections;
using System.Collections.Generic;
using System.Diagnostics;
using System.Threading;
using NUnit.Framework;
using Ros2Gateway.Drive;
using Ros2Gateway.Messages.GeometryMsgs;
using UnityEngine;
using UnityEngine.TestTools;
using Object = UnityEngine.Object;

namespace Ros2Gateway.Unity.Tests
{
    /// <summary>Keys that a test holds.</summary>
    internal sealed class HeldKeys : IDriveInput
    {
        public DriveKeys Held { get; set; }

        public bool StopPressed { get; set; }
    }

    /// <summary>
    /// A scene with a connection, and a second client that observes what a driver in it publishes.
    /// </summary>
    internal sealed class DrivingScene : IDisposable
    {
        internal const string Gateway = "ROS2GATEWAY_TEST_URL";
        internal const string Rogue = "ROS2GATEWAY_ROGUE_URL";

        private const int TimeoutMilliseconds = 120000; // a machine may be busy with other things

        internal readonly GatewayConnection Connection;
        internal readonly GatewayClient Observer;
        internal readonly List<DriveCommand> Heard = new();

        /// <summary>Called while a test waits.</summary>
        internal Action EachFrame = delegate { };

        private readonly List<Object> _made = new();

        /// <param name="topic">The observed topic, of Twist. Null for nothing.</param>
        /// <param name="path">"/through" for a line that "cut" cuts. Empty for the gateway itself.</param>
        internal DrivingScene(string topic, string path = "")
        {
            GatewaySettings settings = ScriptableObject.CreateInstance<GatewaySettings>();
            settings.Address = path.Length > 0 ? Address(Rogue) + path : Address(Gateway);
            _made.Add(settings);
            GameObject holder = New("connection");
            Connection = holder.AddComponent<GatewayConnection>();
            Connection.Settings = settings;
            Observer = new GatewayClient(new GatewayOptions { Address = Address(Gateway) });
            Observer.Connect();
            if (topic != null)
            {
                Observer.Subscribe<TwistMsg>(topic, Hear, new SubscribeOptions { Queue = 1000 });
            }
            holder.SetActive(true);
        }

        internal DriveCommand Last => Heard.Count == 0 ? new DriveCommand(double.NaN, 0) : Heard[Heard.Count - 1];

        /// <summary>An object that is not active yet, so that a component on it can be set up.</summary>
        internal GameObject New(string name)
        {
            GameObject made = new(name);
            made.SetActive(false);
            _made.Add(made);
            return made;
        }

        /// <summary>A command is heard.</summary>
        internal void Hear(TwistMsg twist) => Heard.Add(new DriveCommand(twist.linear.x, twist.angular.z));

        /// <summary>Frames until something holds.</summary>
        internal IEnumerator Until(Func<bool> holds, string what, Action again = null)
        {
            Stopwatch watch = Stopwatch.StartNew();
            while (true)
            {
                Observer.Pump();
                EachFrame();
                if (again != null)
                {
                    again();
                }
                if (holds())
                {
                    yield break;
                }
                if (watch.ElapsedMilliseconds > TimeoutMilliseconds)
                {
                    Assert.Fail("waited in vain " + what + "; heard: " + string.Join(" | ", Heard)
                        + "; events: " + string.Join(" | ", Connection.Events));
                }
                yield return null;
            }
        }

        /// <summary>Frames until a command is the newest that was heard.</summary>
        internal IEnumerator UntilHeard(double linear, double angular)
        {
            DriveCommand command = new(linear, angular);
            return Until(() => Same(Last, command), "for " + command);
        }

        /// <summary>Whether a command was heard since the list was cleared.</summary>
        internal bool HasHeard(double linear, double angular) =>
            Heard.Exists(heard => Same(heard, new DriveCommand(linear, angular)));

        /// <summary>Cuts the line behind "/through". The frame may take until there is another.</summary>
        internal IEnumerator CutAndReconnect(bool isFrozen)
        {
            LogAssert.ignoreFailingMessages = true; // the loss is an error, and is meant
            bool wasCut = false;
            Connection.StateChanged += state => wasCut |= state != ConnectionState.Connected;
            Connection.Client.Request("cut", null, null);
            if (isFrozen)
            {
                Assert.IsTrue(SpinWait.SpinUntil(() => !Connection.Client.IsConnected, TimeoutMilliseconds));
                Assert.IsTrue(SpinWait.SpinUntil(() => Connection.Client.IsConnected, TimeoutMilliseconds));
                yield return null;
                yield break;
            }
            yield return Until(() => wasCut, "for the cut");
            yield return Until(() => Connection.Client.IsConnected, "to be connected again");
        }

        public void Dispose()
        {
            for (int i = _made.Count - 1; i >= 0; i--)
            {
                Object.DestroyImmediate(_made[i]);
            }
            Observer.Dispose();
        }

        private static string Address(string where)
        {
            string address = Environment.GetEnvironmentVariable(where);
            if (string.IsNullOrEmpty(address))
            {
                Assert.Ignore("needs a server: set " + where);
            }
            return address;
        }

        private static bool Same(DriveCommand one, DriveCommand other)
        {
            // the Inspector's speeds are floats
            return Math.Abs(one.linear - other.linear) < 1e-6 && Math.Abs(one.angular - other.angular) < 1e-6;
        }
    }
}
