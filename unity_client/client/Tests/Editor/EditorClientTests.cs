// SPDX-License-Identifier: Apache-2.0
using System;
using System.Diagnostics;
using System.Threading;
using NUnit.Framework;
using Ros2Gateway.Messages.StdMsgs;
using Ros2Gateway.Unity;
using UnityEngine;

namespace Ros2Gateway.Editor.Tests
{
    /// <summary>The inspectors' texts, pumped as the editor does it.</summary>
    [TestFixture]
    public sealed class EditorClientTests
    {
        private const string Nobody = "ws://127.0.0.1:9"; // the port of what is to be discarded
        private const int TimeoutMilliseconds = 120000; // a machine may be busy with other things

        [Test]
        [Category("Gateway")]
        public void AProbeTellsTheServerItsVersionAndTheRoundTrip()
        {
            using ConnectionProbe probe = new(Options("ROS2GATEWAY_TEST_URL"));
            Until(() => probe.IsDone, probe.Pump);
            Assert.IsTrue(probe.IsGood, probe.Text);
            StringAssert.IsMatch(
                @"^ros2-json-gateway \d+\.\S+, ROS 2 [a-z]+, role \w+; round trip \d+\.\d ms$",
                probe.Text);
        }

        [Test]
        public void AProbeTellsWhyNobodyAnswers()
        {
            using ConnectionProbe probe = new(new GatewayOptions { Address = Nobody });
            Until(() => probe.IsDone, probe.Pump);
            Assert.IsFalse(probe.IsGood);
            StringAssert.Contains(Nobody, probe.Text);
            string text = probe.Text;
            probe.Pump();
            Assert.AreEqual(text, probe.Text);
        }

        [Test]
        [Category("Gateway")]
        public void AProbeOfAPortWhereNobodyEverSpeaksEnds()
        {
            GatewayOptions options = Options("ROS2GATEWAY_DEAF_URL");
            options.ConnectMilliseconds = 300;
            using ConnectionProbe probe = new(options);
            Until(() => probe.IsDone, probe.Pump);
            Assert.IsFalse(probe.IsGood);
            Assert.IsNotEmpty(probe.Text);
        }

        [Test]
        [Category("Gateway")]
        public void ATopicThatComesUpIsInTheDropdownWithItsType()
        {
            GatewayOptions options = Options("ROS2GATEWAY_TEST_URL");
            using (GraphDropdown dropdown = new(options))
            using (GatewayClient other = new(options))
            {
                bool isChanged = false;
                dropdown.Changed += () => isChanged = true;
                // connecting, or on a slow machine connected already
                StringAssert.StartsWith("connect", dropdown.Problem);
                Until(() => dropdown.Topics.Contains("/odom"), dropdown.Pump);
                Assert.IsTrue(isChanged);
                Assert.AreEqual("", dropdown.Problem);
                Assert.AreEqual("nav_msgs/msg/Odometry", dropdown.TypeOf("/odom"));
                Assert.AreEqual("", dropdown.TypeOf("/nothing"));
                other.Connect();
                other.Advertise<StringMsg>("/came_up_later");
                Until(() => dropdown.Topics.Contains("/came_up_later"), () =>
                {
                    other.Pump();
                    dropdown.Pump();
                });
                Assert.AreEqual("std_msgs/msg/String", dropdown.TypeOf("came_up_later"));
            }
        }

        [Test]
        public void ADropdownWithoutAGatewaySaysSo()
        {
            using GraphDropdown dropdown = new(new GatewayOptions { Address = Nobody });
            Until(() => !dropdown.Problem.StartsWith("connecting "), dropdown.Pump);
            StringAssert.Contains(Nobody, dropdown.Problem);
            Assert.AreEqual(0, dropdown.Topics.Count);
            Assert.AreEqual("", dropdown.TypeOf("/odom"));
        }

        [Test]
        public void AConnectionsOwnAddressComesBeforeThatOfItsSettings()
        {
            GatewaySettings settings = ScriptableObject.CreateInstance<GatewaySettings>();
            settings.Address = "ws://robot:9090";
            settings.Token = "secret";
            GameObject holder = new("connection");
            holder.SetActive(false);
            GatewayConnection connection = holder.AddComponent<GatewayConnection>();
            Assert.AreEqual(new GatewayOptions().Address, EditorClient.OptionsOf(connection).Address);
            Assert.AreEqual(new GatewayOptions().Address, EditorClient.OptionsOf(null).Address);
            connection.Settings = settings;
            Assert.AreEqual("ws://robot:9090", EditorClient.OptionsOf(connection).Address);
            connection.Address = "ws://other:9090";
            Assert.AreEqual("ws://other:9090", EditorClient.OptionsOf(connection).Address);
            Assert.AreEqual("ws://other:9090", connection.Address);
            Assert.AreEqual("secret", EditorClient.OptionsOf(connection).Token);
            UnityEngine.Object.DestroyImmediate(holder);
            UnityEngine.Object.DestroyImmediate(settings);
        }

        private static GatewayOptions Options(string where)
        {
            string address = Environment.GetEnvironmentVariable(where);
            if (string.IsNullOrEmpty(address))
            {
                Assert.Ignore("needs a server: set " + where);
            }
            return new GatewayOptions { Address = address };
        }

        private static void Until(Func<bool> holds, Action pump)
        {
            Stopwatch watch = Stopwatch.StartNew();
            while (!holds())
            {
                Assert.Less(watch.ElapsedMilliseconds, TimeoutMilliseconds, "waited in vain");
                pump();
                Thread.Sleep(5);
            }
        }
    }
}
