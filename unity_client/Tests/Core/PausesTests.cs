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
        private const long TickMilliseconds = 20;

        [Test]
        public void AGatewayThatComesBackIsFoundWithinTwoSecondsOrSo()
        {
            List<long> pauses = Pauses(60000, () => { throw new InvalidOperationException("no network"); });
            Assert.That(pauses[0], Is.EqualTo(500).Within(500 * Chance + TickMilliseconds));
            Assert.That(pauses[1], Is.EqualTo(1000).Within(1000 * Chance + TickMilliseconds));
            for (int index = 2; index < pauses.Count; index++)
            {
                Assert.That(pauses[index], Is.EqualTo(2000).Within(2000 * Chance + TickMilliseconds));
            }
        }

        [Test]
        public void WhatAcceptsAndKeepsSilentIsAskedRarelyInTheEnd()
        {
            List<long> pauses = Pauses(3600000, () => { });
            Assert.That(pauses.Count, Is.InRange(60, 100));
            const long GivenUpMilliseconds = 10000; // after so long an attempt is forgotten
            long last = pauses[pauses.Count - 1] - GivenUpMilliseconds;
            Assert.That(last, Is.EqualTo(60000).Within(60000 * Chance + 2 * TickMilliseconds));
        }

        /// <summary>The times from one attempt to the next, while each opens so.</summary>
        private static List<long> Pauses(long milliseconds, Action open)
        {
            long now = 0;
            var begun = new List<long>();
            var options = new GatewayOptions();
            options.Transport = _ => new Dead(() =>
            {
                begun.Add(now);
                open();
            });
            var link = new Link(options, new Nobody());
            link.Connect(now);
            while (now < milliseconds)
            {
                now += TickMilliseconds;
                link.Tick(now);
            }
            var pauses = new List<long>();
            for (int index = 1; index < begun.Count; index++)
            {
                pauses.Add(begun[index] - begun[index - 1]);
            }
            return pauses;
        }

        /// <summary>A transport that says nothing.</summary>
        private sealed class Dead : ITransport
        {
            private readonly Action _open;

            internal Dead(Action open)
            {
                _open = open;
            }

            public void Open(Uri address, ITransportListener listener)
            {
                _open();
            }

            public bool TrySend(byte[] buffer, int count)
            {
                return false;
            }

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

            public void Report(EventLevel level, string text)
            {
            }
        }
    }
}
