// SPDX-License-Identifier: Apache-2.0
using System;
using System.Diagnostics;
using System.Linq;
using System.Net;
using System.Text;
using System.Threading;
using NUnit.Framework;

namespace Ros2Gateway.Tests
{
    [TestFixture]
    public sealed class GatewayFinderTests
    {
        private const int TimeoutMilliseconds = 120000; // a machine may be busy with other things

        // all gateways of this machine, and no other
        private static readonly IPAddress Here = IPAddress.Parse("127.255.255.255");

        [Test]
        [Category("Gateway")]
        public void A_gateway_on_all_networks_is_found_with_its_address()
        {
            int port = new Uri(Live.Address(Live.Gateway)).Port;
            using var finder = new GatewayFinder(Here);
            Until(finder, () => finder.Found.Any(each => IsAt(each, port)));
            FoundGateway found = finder.Found.Single(each => IsAt(each, port));
            Assert.AreEqual("ws://127.0.0.1:" + port + "/", found.Address);
            Assert.IsFalse(found.NeedsToken);
            Assert.IsNull(found.SecureAddress);
            Assert.IsNotEmpty(found.Name);
            Assert.IsNull(finder.Problem);
            using Live live = new(Live.Gateway, "", options => options.Address = found.Address);
            live.Client.Connect();
            live.Until(() => live.Client.IsConnected, "to be connected");
        }

        [Test]
        public void An_answer_is_read()
        {
            FoundGateway found = Read(Answer());
            Assert.AreEqual("robot7", found.Name);
            Assert.AreEqual("ws://10.0.0.7:9090/ros", found.Address);
            Assert.AreEqual("wss://10.0.0.7:9443/ros", found.SecureAddress);
            Assert.IsTrue(found.NeedsToken);
            Assert.AreEqual("wss://10.0.0.7:9090/ros", Read(Answer().Replace("\"tls\":false", "\"tls\":true")).Address);
        }

        [Test]
        public void A_gateway_that_is_heard_twice_is_listed_once_at_the_address_for_other_machines()
        {
            using var finder = new GatewayFinder(Here);
            foreach (string sender in new[] { "127.0.0.1", "10.0.0.7", "127.0.0.1", "10.0.0.7" })
            {
                finder.Add(Read(Answer(), sender));
            }
            Assert.AreEqual("ws://10.0.0.7:9090/ros", finder.Found.Single().Address);
            finder.Add(Read(Answer().Replace("4f1d", "5a"), "10.0.0.8"));
            Assert.AreEqual(2, finder.Found.Count);
        }

        [TestCase("")]
        [TestCase("[]")]
        [TestCase("{\"op\":\"find_gateways\"}")]
        public void What_is_no_answer_is_ignored(string datagram) => Assert.IsNull(Read(datagram));

        [TestCase("\"port\":9090", "\"port\":65536")]
        [TestCase("\"port\":9090", "\"port\":\"9090\"")]
        [TestCase("\"/ros\"", "\"ros\"")]
        [TestCase("\"4f1d\"", "7")]
        public void An_answer_with_a_part_that_cannot_be_is_ignored(string part, string other) =>
            Assert.IsNull(Read(Answer().Replace(part, other)));

        [Test]
        public void Bytes_that_are_no_text_are_ignored() =>
            Assert.IsNull(FoundGateway.Read(new byte[] { 0xff, 0xfe, 0x00 }, 3, IPAddress.Loopback));

        [Test]
        public void After_its_end_it_does_nothing()
        {
            var finder = new GatewayFinder(Here);
            finder.Dispose();
            finder.Pump();
            finder.Dispose();
            Assert.IsEmpty(finder.Found);
        }

        [Test]
        public void Where_nobody_can_be_asked_it_says_so()
        {
            using var finder = new GatewayFinder(IPAddress.Parse("0.0.0.0").MapToIPv6());
            finder.Pump();
            Assert.IsEmpty(finder.Found);
            StringAssert.StartsWith("cannot look for gateways: ", finder.Problem);
        }

        private static bool IsAt(FoundGateway found, int port) => found.Address.Contains(":" + port + "/");

        private static string Answer() =>
            "{\"op\":\"gateway\",\"id\":\"4f1d\",\"name\":\"robot7\",\"port\":9090,\"path\":\"/ros\","
                + "\"tls\":false,\"tls_port\":9443,\"token\":true,\"version\":\"0.1.0\"}";

        private static FoundGateway Read(string datagram, string sender = "10.0.0.7")
        {
            byte[] bytes = Encoding.UTF8.GetBytes(datagram);
            return FoundGateway.Read(bytes, bytes.Length, IPAddress.Parse(sender));
        }

        private static void Until(GatewayFinder finder, Func<bool> holds)
        {
            Stopwatch watch = Stopwatch.StartNew();
            while (!holds())
            {
                Assert.Less(watch.ElapsedMilliseconds, TimeoutMilliseconds, finder.Problem);
                finder.Pump();
                Thread.Sleep(5);
            }
        }
    }
}
