// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using NUnit.Framework;

namespace Ros2Gateway.Tests
{
    /// <summary>When a link tries again, by a clock of the test's own.</summary>
    public class PausesTests
    {
        // the share of a pause that is chance, to either side
        private const double Chance = 0.2;
        private const long TickMilliseconds = 30;
        private const long Never = long.MaxValue;

        [Test]
        public void AGatewayThatComesBackIsFoundWithinTwoSecondsOrSo()
        {
            List<long> pauses = Pauses(60000, 0);
            Assert.That(pauses[0], Is.EqualTo(500).Within(500 * Chance + TickMilliseconds));
            Assert.That(pauses[1], Is.EqualTo(1000).Within(1000 * Chance + TickMilliseconds));
            for (int index = 2; index < pauses.Count; index++)
            {
                Assert.That(pauses[index], Is.EqualTo(2000).Within(2000 * Chance + TickMilliseconds));
            }
        }

        // A transport that gives up by itself after 5 s does so between two ticks. One that never does is forgotten after 10.
        [TestCase(5001, 5001)]
        [TestCase(Never, 10000)]
        public void WhatAcceptsAndKeepsSilentIsAskedRarelyInTheEnd(long closedAfter, long takes)
        {
            List<long> pauses = Pauses(3600000, closedAfter);
            double often = 2000 * (1 + Chance) + takes + 2 * TickMilliseconds;
            Assert.That(pauses.FindAll(pause => pause <= often).Count, Is.EqualTo(121).Within(3));
            Assert.That(pauses[pauses.Count - 1] - takes,
                Is.EqualTo(60000).Within(60000 * Chance + 2 * TickMilliseconds));
        }

        [TestCase("ws://robot:9090", "ws://robot:9090/?status=warning")]
        [TestCase("wss://[::1]/a?images=raw&status=none", "wss://[::1]/a?status=warning&images=raw&status=none")]
        public void TheGatewayIsAskedForWarningsUnlessTheAddressSaysOtherwise(string address, string opened)
        {
            var transport = new Silent();
            var options = new GatewayOptions { Address = address, Transport = _ => transport };
            new Link(options, new Nobody()).Connect(0);
            Assert.That(transport.Address.AbsoluteUri, Is.EqualTo(opened));
        }

        /// <summary>The times from one attempt to the next, if each ends so long after it began.</summary>
        private static List<long> Pauses(long milliseconds, long closedAfter)
        {
            long now = 0;
            var begun = new List<long>();
            Silent transport = null;
            var options = new GatewayOptions();
            options.Transport = _ =>
            {
                begun.Add(now);
                return transport = new Silent();
            };
            var link = new Link(options, new Nobody());
            link.Connect(now);
            while (now < milliseconds)
            {
                now += TickMilliseconds;
                if (transport != null && now - begun[begun.Count - 1] > closedAfter)
                {
                    transport.Listener.OnClosed(0, "not connected");
                    transport = null;
                }
                link.Tick(now);
            }
            var pauses = new List<long>();
            for (int index = 1; index < begun.Count; index++)
            {
                pauses.Add(begun[index] - begun[index - 1]);
            }
            return pauses;
        }

        private sealed class Silent : ITransport
        {
            internal ITransportListener Listener { get; private set; }

            internal Uri Address { get; private set; }

            public void Open(Uri address, ITransportListener listener)
            {
                Address = address;
                Listener = listener;
            }

            public bool TrySend(byte[] buffer, int count) => false;

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

        private sealed class Nobody : ILinkOwner
        {
            public void OnUp(ITransport transport)
            {
            }

            public void OnFrame(byte[] buffer, int count)
            {
            }

            public void OnSent(ITransport transport)
            {
            }

            public void OnHeartbeat()
            {
            }

            public void OnDown(string errorText)
            {
            }

            public void OnState(ConnectionState state)
            {
            }

            public void OnRefused(string text)
            {
            }

            public void Report(EventLevel level, string text)
            {
            }
        }
    }
}
