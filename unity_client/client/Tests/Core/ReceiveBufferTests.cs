// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Text;
using System.Threading;
using NUnit.Framework;
using Ros2Gateway.Messages.SensorMsgs;

namespace Ros2Gateway.Tests
{
    /// <summary>The buffer that a transport keeps for frames, which listeners see.</summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class ReceiveBufferTests
    {
        private const int LargeBytes = 1500000; // more than is kept for rare frames
        private const int SmallFrames = 1000; // after so many a large one was rare

        [Test]
        public void LargeFramesAgainAndAgainShareABufferWhichIsGivenBackOnceTheyAreRare()
        {
            using (Live live = Live.Connected())
            using (WebSocketTransport transport = new(60000, 16 * 1024 * 1024))
            {
                Publisher<PointCloud2Msg> publisher = live.Client.Advertise<PointCloud2Msg>(
                    "/large_cloud", new AdvertiseOptions { Queue = 1 });
                PointCloud2Msg cloud = new() { data = new byte[LargeBytes] };
                Frames frames = new();
                transport.Open(new Uri(Live.Address(Live.Gateway)), frames);
                live.Until(() => frames.IsOpen, "for the transport");
                Send(live, transport, "{\"op\":\"subscribe\",\"topic\":\"/large_cloud\",\"compression\":\"cbor\","
                    + "\"type\":\"sensor_msgs/msg/PointCloud2\"}");
                live.Until(
                    () => frames.Seen().Count >= 5,
                    "for clouds",
                    () =>
                    {
                        publisher.Publish(cloud);
                        live.Client.Pump();
                        Thread.Sleep(20);
                    });
                publisher.Dispose();
                List<byte[]> large = frames.Seen();
                Assert.IsTrue(ReferenceEquals(large[1], large[4]), "another buffer");
                int sent = 0;
                live.Until(
                    () => frames.GivenBackAfter > 0,
                    "for the buffer to be given back",
                    () =>
                    {
                        if (sent <= frames.Small + 50) // no more than the gateway answers
                        {
                            Send(live, transport, "{\"op\":\"ping\"}");
                            sent++;
                        }
                    });
                Assert.AreEqual(SmallFrames, frames.GivenBackAfter, "frames after the last large one");
            }
        }

        private static void Send(Live live, ITransport transport, string operation)
        {
            byte[] bytes = Encoding.UTF8.GetBytes(operation);
            live.Until(() => transport.TrySend(bytes, bytes.Length), "to be sent", () => { });
        }

        private sealed class Frames : ITransportListener
        {
            private readonly List<byte[]> _large = new();
            internal volatile bool IsOpen;
            internal volatile int Small;
            internal volatile int GivenBackAfter;
            private int _sinceLarge;

            internal List<byte[]> Seen()
            {
                lock (_large)
                {
                    return new List<byte[]>(_large);
                }
            }

            public void OnOpen() => IsOpen = true;

            public void OnProgress()
            {
            }

            public void OnFrame(byte[] buffer, int count)
            {
                if (count >= LargeBytes)
                {
                    lock (_large)
                    {
                        _large.Add(buffer);
                    }
                    _sinceLarge = 0;
                    GivenBackAfter = 0;
                    return;
                }
                Small++;
                if (Seen().Count > 0 && buffer.Length < LargeBytes && GivenBackAfter == 0)
                {
                    GivenBackAfter = _sinceLarge;
                }
                _sinceLarge++;
            }

            public void OnOversized(long bytes)
            {
            }

            public void OnSent()
            {
            }

            public void OnClosed(int code, string reason)
            {
            }
        }
    }
}
