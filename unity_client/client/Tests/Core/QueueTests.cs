// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Text.RegularExpressions;
using NUnit.Framework;
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Messages.SensorMsgs;
using Ros2Gateway.Messages.StdMsgs;

namespace Ros2Gateway.Tests
{
    /// <summary>The queues, and their drops, over a network that a test holds.</summary>
    [TestFixture]
    public sealed class QueueTests
    {
        private readonly List<GatewayEvent> _events = new();
        private StuckTransport _network;
        private GatewayClient _client;

        [SetUp]
        public void SetUp()
        {
            _events.Clear();
            _network = new StuckTransport();
            _client = new GatewayClient(new GatewayOptions { Transport = options => _network, UsesThreads = false });
            _client.EventHeard += _events.Add;
            _client.Connect();
        }

        [TearDown]
        public void TearDown() => _client.Dispose();

        [Test]
        public void ABurstOfAFrameWaitsWholeForANetworkThatIsBusy()
        {
            Publisher<Int64Msg> publisher = _client.Advertise<Int64Msg>("/numbers");
            Hold();
            Publish(publisher, 1, 500);
            Assert.AreEqual(0, publisher.Dropped);
            _network.Release();
            CollectionAssert.AreEqual(Range(1, 500), Sent());
        }

        [Test]
        public void OfWhatHasWaitedForFramesTheNewestTenStay()
        {
            long told = 0;
            Publisher<Int64Msg> publisher = _client.Advertise<Int64Msg>("/numbers");
            publisher.DroppedChanged += count => told = count;
            Hold();
            Publish(publisher, 1, 20);
            PassFrames();
            Publish(publisher, 21, 21);
            Assert.AreEqual(11, publisher.Dropped);
            Assert.AreEqual(0, told, "told outside Pump");
            _client.Pump();
            Assert.AreEqual(11, told);
            _client.Pump();
            Assert.IsTrue(_events.Exists(one => one.Code == "dropped" && one.Request == "publish"
                && one.Text.StartsWith("/numbers: 11 messages were dropped, 11 in all: more than 10 waited for the network")));
            _network.Release();
            CollectionAssert.AreEqual(Range(12, 21), Sent());
        }

        [Test]
        public void ABurstHasABoundOfMessages()
        {
            Publisher<Int64Msg> publisher = _client.Advertise<Int64Msg>("/numbers");
            Hold();
            Publish(publisher, 1, 1100);
            Assert.AreEqual(1100 - 1024, publisher.Dropped);
        }

        [Test]
        public void ABurstHasABoundOfBytesButTenWaitAnyway()
        {
            Publisher<StringMsg> publisher = _client.Advertise<StringMsg>("/texts");
            Hold();
            StringMsg text = new() { data = new string('x', 100000) };
            for (int i = 0; i < 30; i++)
            {
                publisher.Publish(text);
            }
            Assert.AreEqual(20, publisher.Dropped);
        }

        [Test]
        public void AQueueOfOneKeepsTheNewestAloneAndThatIsNoEvent()
        {
            Publisher<Int64Msg> publisher = _client.Advertise<Int64Msg>("/numbers", new AdvertiseOptions { Queue = 1 });
            Hold();
            Publish(publisher, 1, 20);
            Assert.AreEqual(19, publisher.Dropped);
            _client.Pump();
            _client.Pump();
            Assert.IsFalse(_events.Exists(one => one.Code == "dropped"));
            _network.Release();
            CollectionAssert.AreEqual(new long[] { 20 }, Sent());
        }

        [Test]
        public void OfCommandsOnATopicThatMovesARobotTheNewestAloneWaits()
        {
            Publisher<TwistMsg> publisher = _client.Advertise<TwistMsg>("/cmd_vel");
            _network.Receive("{\"op\":\"control\",\"topic\":\"/cmd_vel\",\"state\":\"stopped\",\"tripped\":false,"
                + "\"cause\":null,\"holder\":null,\"guard\":\"ready\",\"deadline_s\":0.5,\"lease_s\":2.0}");
            Hold();
            TwistMsg twist = new();
            for (int i = 0; i < 5; i++)
            {
                twist.linear.x = 0.1;
                Assert.IsTrue(publisher.Publish(twist));
            }
            Assert.AreEqual(4, publisher.Dropped);
        }

        [Test]
        public void AListenerThatThrowsHarmsNoOtherAndIsToldOnceWithACount()
        {
            List<string> heard = new();
            _client.EventHeard += happened => { throw new InvalidOperationException("not mine"); };
            _client.EventHeard += happened => heard.Add(happened.Text);
            for (int i = 0; i < 15; i++)
            {
                _client.Advertise("/" + i, "std_msgs/msg/String").Publish(null); // an event
                _client.Pump();
            }
            PassFrames();
            Assert.AreEqual(15, heard.FindAll(text => text.EndsWith("no message")).Count);
            List<string> faults = heard.FindAll(text => text.Contains("listener of events threw"));
            CollectionAssert.AreEqual(
                new[]
                {
                    "listener of events threw InvalidOperationException: not mine",
                    "listener of events threw InvalidOperationException, 10 times by now: not mine",
                },
                faults);
        }

        [Test]
        public void AHandlerThatThrowsIsToldOnceWithACountAndGetsTheNextMessage()
        {
            int calls = 0;
            Subscription<Int64Msg> subscription = _client.Subscribe<Int64Msg>("/numbers", message =>
            {
                calls++;
                throw new InvalidOperationException("not now");
            });
            for (int i = 0; i < 15; i++)
            {
                _network.Receive("{\"op\":\"publish\",\"topic\":\"/numbers\",\"msg\":{\"data\":1}}");
                _client.Pump();
            }
            PassFrames();
            Assert.AreEqual(15, calls);
            Assert.AreEqual(15, subscription.Received);
            Assert.AreEqual(2, _events.FindAll(one => one.Text.StartsWith("handler of /numbers threw")).Count);
        }

        [Test]
        public void AsMuchAsWantedWaitsAtTheGatewayToo()
        {
            _client.Subscribe<Int64Msg>("/default");
            _client.Subscribe<Int64Msg>("/newest", null, new SubscribeOptions { Queue = 1 });
            _client.Subscribe<Int64Msg>("/long", null, new SubscribeOptions { Queue = 200 });
            Assert.IsFalse(Subscribe("/default").Contains("queue_length"));
            StringAssert.Contains("\"queue_length\":1,", Subscribe("/newest"));
            StringAssert.Contains("\"queue_length\":200,", Subscribe("/long"));
        }

        [Test]
        public void OfSeveralPicturesOfATopicTheLargestIsAskedFor()
        {
            Subscription<CompressedImageMsg> wall = Picture(640, 480);
            Assert.AreEqual("\"max_width\":640,\"max_height\":480", Bounds());
            Subscription<CompressedImageMsg> wrist = Picture(320, 800);
            Assert.AreEqual("\"max_width\":640,\"max_height\":800", Bounds());
            wrist.ChangeImage(new ImageOptions { MaxWidth = 160 });
            Assert.AreEqual("\"max_width\":640", Bounds(), "0 is any height");
            wall.ChangeImage(null);
            Assert.AreEqual("", Bounds(), "that of the wall is any, now");
            wall.Dispose();
            int sent = _network.Sent.Count;
            wall.ChangeImage(new ImageOptions { MaxWidth = 32 });
            Assert.AreEqual(sent, _network.Sent.Count, "it has ended");
        }

        private Subscription<CompressedImageMsg> Picture(int width, int height) => _client.Subscribe<CompressedImageMsg>(
            "/camera", "sensor_msgs/msg/Image", () => new CompressedImageMsg(), null,
            new SubscribeOptions { Image = new ImageOptions { MaxWidth = width, MaxHeight = height } });

        // of the newest subscription
        private string Bounds()
        {
            string frame = _network.Sent.FindLast(one => one.Contains("\"subscribe\"") && one.Contains("/camera"));
            return Regex.Match(frame, "\"max_[^}]*").Value;
        }

        private string Subscribe(string topic) =>
            _network.Sent.Find(frame => frame.Contains("\"subscribe\"") && frame.Contains(topic));

        // One frame is with the network from now on, and no other is taken.
        private void Hold()
        {
            _network.IsFree = false;
            _client.Advertise("/held", "std_msgs/msg/String");
        }

        private void PassFrames()
        {
            _client.Pump();
            _client.Pump();
            _client.Pump();
        }

        private static void Publish(Publisher<Int64Msg> publisher, int from, int to)
        {
            for (int i = from; i <= to; i++)
            {
                Assert.IsTrue(publisher.Publish(new Int64Msg { data = i }));
            }
        }

        private List<long> Sent()
        {
            List<long> numbers = new();
            foreach (string frame in _network.Sent)
            {
                int at = frame.IndexOf("\"data\":");
                if (at >= 0)
                {
                    numbers.Add(long.Parse(frame.Substring(at + 7).TrimEnd('}')));
                }
            }
            return numbers;
        }

        private static List<long> Range(int from, int to)
        {
            List<long> numbers = new();
            for (int i = from; i <= to; i++)
            {
                numbers.Add(i);
            }
            return numbers;
        }
    }
}
