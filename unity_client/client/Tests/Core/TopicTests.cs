// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;
using NUnit.Framework;
using Ros2Gateway.Json;
using Ros2Gateway.Messages.BuiltinInterfaces;
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Messages.NavMsgs;
using Ros2Gateway.Messages.SensorMsgs;
using Ros2Gateway.Messages.StdMsgs;
using Ros2Gateway.Pictures;

namespace Ros2Gateway.Tests
{
    /// <summary>Topics both ways, through a live gateway.</summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class TopicTests
    {
        private const string Type = "test/msg/Padded"; // of a server that knows no types

        [Test]
        public void OdometryOfTheRobotComesAsATypedMessage()
        {
            using Live live = Live.Connected();
            OdometryMsg odometry = null;
            live.Client.Subscribe<OdometryMsg>("odom", message => odometry = message);
            live.Until(() => odometry != null, "for odometry");
            Assert.AreEqual("odom", odometry.header.frame_id);
            Assert.AreEqual("base_footprint", odometry.child_frame_id);
            Assert.Greater(odometry.header.stamp.sec, 0);
            Assert.AreEqual(36, odometry.pose.covariance.Length);
        }

        [Test]
        public void APictureComesAsJpegOfTheWantedSize()
        {
            using Live live = Live.Connected();
            CompressedImageMsg picture = null;
            live.Client.Subscribe<CompressedImageMsg>(
                "/camera/image_raw", "sensor_msgs/msg/Image", () => new CompressedImageMsg(), message => picture = message,
                new SubscribeOptions { Image = new ImageOptions { Quality = 50, Adapt = true, MaxWidth = 320 } });
            live.Until(() => picture != null, "for a picture");
            Assert.AreEqual("jpeg", picture.format);
            Assert.AreEqual(0xFF, picture.data[0]);
            Assert.AreEqual(0xD8, picture.data[1]);
        }

        [Test]
        public void OnlyTheFieldsThatWereAskedForCome()
        {
            using Live live = Live.Connected();
            OdometryMsg odometry = null;
            live.Client.Subscribe<OdometryMsg>(
                "/odom", message => odometry = message,
                new SubscribeOptions { Fields = new[] { "child_frame_id" }, ThrottleMilliseconds = 50 });
            live.Until(() => odometry != null, "for odometry");
            Assert.AreEqual("base_footprint", odometry.child_frame_id);
            Assert.AreEqual("", odometry.header.frame_id);
        }

        [Test]
        public void AQueueKeepsMessagesInOrderAndDropsTheOldest()
        {
            using Live live = Live.Connected();
            Publisher<Int64Msg> publisher = live.Client.Advertise<Int64Msg>(
                "/numbers", new AdvertiseOptions { Queue = 100 });
            Subscription<Int64Msg> all = live.Client.Subscribe<Int64Msg>(
                "/numbers", null, new SubscribeOptions { Queue = 100 });
            Subscription<Int64Msg> some = live.Client.Subscribe<Int64Msg>(
                "/numbers", null, new SubscribeOptions { Queue = 5 });
            Subscription<Int64Msg> newest = live.Client.Subscribe<Int64Msg>(
                "/numbers", null, new SubscribeOptions { Queue = 1 });
            WaitUntilHeard(live, publisher, all);
            Empty(all);
            Empty(some);

            for (int i = 1; i <= 20; i++)
            {
                Assert.IsTrue(publisher.Publish(new Int64Msg { data = i }));
            }
            live.Until(() => all.Waiting == 20, "for all numbers");
            LetFramesPass(live);
            publisher.Publish(new Int64Msg { data = 21 });
            live.Until(() => all.Waiting == 21, "for one more");

            CollectionAssert.AreEqual(Numbers(1, 21), Empty(all));
            CollectionAssert.AreEqual(Numbers(17, 21), Empty(some));
            CollectionAssert.AreEqual(Numbers(21, 21), Empty(newest));
        }

        [Test]
        public void ABurstWithinAFrameIsWholeByDefault()
        {
            using Live live = Live.Connected();
            List<long> handled = new();
            Publisher<Int64Msg> publisher = live.Client.Advertise<Int64Msg>("/numbers");
            Subscription<Int64Msg> all = live.Client.Subscribe<Int64Msg>("/numbers", message => handled.Add(message.data));
            WaitUntilHeard(live, publisher, all);
            live.Client.Pump();
            handled.Clear();
            long before = all.Received;
            long droppedBefore = publisher.Dropped + all.Dropped; // on a busy machine, while it found the other

            // Nothing is pumped until all are here: as long as a frame of the application.
            for (int i = 1; i <= 200; i++)
            {
                Assert.IsTrue(publisher.Publish(new Int64Msg { data = i }));
            }
            live.Until(() => all.Received - before == 200, "for all numbers", () => { });
            Assert.AreEqual(200, all.Waiting);
            live.Until(() => handled.Count == 200, "for the handler");

            CollectionAssert.AreEqual(Numbers(1, 200), handled);
            Assert.AreEqual(droppedBefore, publisher.Dropped + all.Dropped);
        }

        [Test]
        public void WhatTheApplicationLeavesIsDroppedAndToldWithACount()
        {
            using Live live = Live.Connected();
            int here = System.Threading.Thread.CurrentThread.ManagedThreadId;
            List<long> told = new();
            Publisher<Int64Msg> publisher = live.Client.Advertise<Int64Msg>("/numbers");
            Subscription<Int64Msg> taken = live.Client.Subscribe<Int64Msg>("/numbers");
            WaitUntilHeard(live, publisher, taken);
            Empty(taken);
            long before = taken.Dropped;
            taken.DroppedChanged += count =>
            {
                Assert.AreEqual(here, System.Threading.Thread.CurrentThread.ManagedThreadId);
                told.Add(count - before);
            };

            for (int i = 1; i <= 20; i++)
            {
                publisher.Publish(new Int64Msg { data = i });
            }
            // without a frame of the application: within one a burst is whole, however long it takes
            live.Until(() => taken.Waiting == 20, "for all numbers", () => { });
            LetFramesPass(live);
            publisher.Publish(new Int64Msg { data = 21 });
            live.Until(() => told.Count > 0, "to be told");

            CollectionAssert.AreEqual(new[] { 11 }, told);
            CollectionAssert.AreEqual(Numbers(12, 21), Empty(taken));
            live.Until(() => live.Heard("more than 10 waited for the application"), "for words");
        }

        [Test]
        public void APublisherWhoseTopicIsRefusedSaysSoUntilTheReasonIsGone()
        {
            using (Live other = Live.Connected())
            using (Live live = Live.Connected())
            {
                Publisher<StringMsg> first = other.Client.Advertise<StringMsg>("/of_one_type");
                bool isThere = false; // else it might be the one that comes later, and is refused
                Subscription<StringMsg> hearing = other.Client.Subscribe<StringMsg>(
                    "/of_one_type", message => isThere = true);
                other.Until(() => isThere, "to be heard", () =>
                {
                    first.Publish(new StringMsg());
                    other.Client.Pump();
                });
                Int64Msg heard = null;
                Publisher<Int64Msg> refused = live.Client.Advertise<Int64Msg>("/of_one_type");
                live.Until(() => !refused.Publish(new Int64Msg()), "to be refused");
                StringAssert.Contains("has type std_msgs/msg/String, not std_msgs/msg/Int64", refused.Refusal);
                long before = refused.Published;
                for (int i = 0; i < 47; i++)
                {
                    Assert.IsFalse(refused.Publish(new Int64Msg { data = i }));
                }
                Assert.AreEqual(before, refused.Published);

                first.Dispose();
                hearing.Dispose();
                live.Until(() => refused.Refusal == null, "to be taken");
                live.Client.Subscribe<Int64Msg>("/of_one_type", message => heard = message);
                live.Until(() => heard != null && heard.data == 48, "for a message", () =>
                {
                    Assert.IsTrue(refused.Publish(new Int64Msg { data = 48 }));
                    live.Client.Pump();
                });
                List<GatewayEvent> refusals = live.Events.FindAll(one => one.Code == "type_conflict" && one.Request == "advertise");
                Assert.AreEqual(1, refusals.Count, string.Join(" | ", live.Events));
            }
        }

        [Test]
        public void WhatIsPublishedComesBackWithEveryDigitAndCharacter()
        {
            using Live live = Live.Connected();
            Publisher<PoseStampedMsg> publisher = live.Client.Advertise<PoseStampedMsg>("/somewhere");
            Subscription<PoseStampedMsg> subscription = live.Client.Subscribe<PoseStampedMsg>("/somewhere");
            PoseStampedMsg sent = new();
            sent.header.frame_id = "käse \"\\\u0001 \ud83d\ude00";
            sent.header.stamp.sec = 7;
            sent.pose.position.x = 0.1 + 0.2;
            sent.pose.position.y = double.NaN;
            sent.pose.orientation.w = -1e-300;
            PoseStampedMsg got = null;
            live.Until(() => subscription.TryTake(out got), "for the pose", () => publisher.Publish(sent));
            Assert.AreEqual(sent.header.frame_id, got.header.frame_id);
            Assert.AreEqual(sent.pose.position.x, got.pose.position.x);
            Assert.IsNaN(got.pose.position.y);
            Assert.AreEqual(sent.pose.orientation.w, got.pose.orientation.w);
        }

        [Test]
        public void AnInfiniteRangeAndAStampOfZeroSurviveTheWayToROSAndBackTwice()
        {
            using Live live = Live.Connected();
            Publisher<LaserScanMsg> publisher = live.Client.Advertise<LaserScanMsg>("/rays");
            Subscription<LaserScanMsg> subscription = live.Client.Subscribe<LaserScanMsg>("/rays");
            LaserScanMsg sent = new();
            sent.header.stamp = new TimeMsg();
            sent.range_max = float.PositiveInfinity;
            sent.ranges = new[] { 1.5f, float.PositiveInfinity, float.NaN, float.NegativeInfinity, 0.1f };
            LaserScanMsg got = null;
            live.Until(() => subscription.TryTake(out got), "for the scan", () => publisher.Publish(sent));
            for (int i = 0; i < 2; i++)
            {
                Assert.AreEqual(0, got.header.stamp.sec);
                Assert.AreEqual(0, got.header.stamp.nanosec);
                CollectionAssert.AreEqual(sent.ranges, got.ranges);
                Assert.AreEqual(float.PositiveInfinity, got.range_max);
                LaserScanMsg again = got;
                again.header.frame_id = "what was read";
                live.Until(
                    () => subscription.TryTake(out got) && got.header.frame_id == again.header.frame_id,
                    "for the scan again",
                    () =>
                    {
                        live.Client.Pump();
                        publisher.Publish(again);
                    });
            }
        }

        [Test]
        public void PicturesComeInBinaryFramesUnlessTextIsAskedFor([Values(true, false)] bool isBinary)
        {
            using Live live = Live.Connected();
            long pictures = 0;
            long octets = 0;
            live.Client.Subscribe<CompressedImageMsg>(
                "/camera/image_raw/compressed",
                message =>
                {
                    pictures++;
                    octets += message.data.Length;
                },
                new SubscribeOptions { Queue = 100, Binary = isBinary ? null : (bool?)false });
            live.Until(() => pictures > 0, "for a picture");
            pictures = octets = 0;
            long before = live.Client.BytesReceived;
            live.Until(() => pictures >= 20, "for pictures");
            double share = (double)(live.Client.BytesReceived - before) / octets;
            // base64 takes a third more. Other frames, such as answers to pings, are small
            Assert.AreEqual(isBinary, share < 1.2, share + " bytes for an octet");
        }

        [Test]
        public void AnyMessageMayComeInABinaryFrameAlsoAsATree()
        {
            using Live live = Live.Connected();
            OdometryMsg odometry = null;
            DynamicMessage tree = null;
            SubscribeOptions binary = new() { Binary = true };
            live.Client.Subscribe<OdometryMsg>("/odom", message => odometry = message, binary);
            live.Client.Subscribe("/odom", "", () => new DynamicMessage(""), message => tree = message, binary);
            live.Until(() => odometry != null && tree != null, "for odometry");
            Assert.AreEqual("base_footprint", odometry.child_frame_id);
            Assert.AreEqual(36, odometry.pose.covariance.Length);
            Assert.AreEqual("base_footprint", tree.Value["child_frame_id"].AsString());
            Assert.AreEqual(36, tree.Value["pose"]["covariance"].Count);
        }

        [Test]
        public void MessagesAreFilledAnewOnDemandAndEachIsTheHandlersUntilTheNext()
        {
            using Live live = Live.Connected();
            Publisher<Int64Msg> publisher = live.Client.Advertise<Int64Msg>(
                "/filled_anew", new AdvertiseOptions { Queue = 100 });
            List<long> seen = new();
            HashSet<Int64Msg> objects = new();
            Int64Msg last = null;
            long lastData = 0;
            live.Client.Subscribe<Int64Msg>(
                "/filled_anew",
                message =>
                {
                    last = message;
                    lastData = message.data;
                    seen.Add(message.data);
                    objects.Add(message);
                },
                new SubscribeOptions { Queue = 1 },
                reuse: true);
            long next = 0;
            live.Until(
                () => seen.Count >= 60,
                "for numbers",
                () =>
                {
                    publisher.Publish(new Int64Msg { data = ++next });
                    Assert.IsTrue(last == null || last.data == lastData, "it changed in the handler's hands");
                    live.Client.Pump(); // which hands out the next one
                });
            CollectionAssert.IsOrdered(seen);
            // one that waits, one that is read, one in the handler's hands
            Assert.LessOrEqual(objects.Count, 3);
        }

        [Test]
        public void PicturesThatAreFilledAnewKeepTheirBuffers([Values(true, false)] bool isBinary)
        {
            using Live live = Live.Connected();
            HashSet<PictureMsg> objects = new();
            int pictures = 0;
            live.Client.Subscribe<PictureMsg>(
                "/camera/image_raw/compressed",
                picture =>
                {
                    pictures++;
                    objects.Add(picture);
                    Assert.AreEqual(0xFFD8, (picture.buffer[0] << 8) | picture.buffer[1], "where it begins");
                    Assert.AreEqual(
                        0xFFD9,
                        (picture.buffer[picture.count - 2] << 8) | picture.buffer[picture.count - 1],
                        "where it ends");
                    Assert.AreEqual(picture.count, picture.Copy().data.Length);
                },
                new SubscribeOptions { Binary = isBinary, Queue = 1 },
                reuse: true);
            live.Until(() => pictures >= 20, "for pictures");
            Assert.LessOrEqual(objects.Count, 3);
        }

        [Test]
        public void AScanThatIsFilledAnewKeepsItsArray()
        {
            using Live live = Live.Connected();
            HashSet<float[]> arrays = new();
            int scans = 0;
            live.Client.Subscribe<LaserScanMsg>(
                "/scan",
                message =>
                {
                    arrays.Add(message.ranges);
                    Assert.AreEqual(360, message.ranges.Length);
                    scans++;
                },
                new SubscribeOptions { Queue = 1 },
                reuse: true);
            live.Until(() => scans >= 10, "for scans");
            Assert.LessOrEqual(arrays.Count, 3);
        }

        [Test]
        public void ATypeWithoutAClassCanBeReadAsATree()
        {
            using Live live = Live.Connected();
            DynamicMessage odometry = null;
            live.Client.Subscribe("/odom", "", () => new DynamicMessage(""), message => odometry = message);
            live.Until(() => odometry != null, "for odometry");
            Assert.AreEqual("base_footprint", odometry.Value["child_frame_id"].AsString());
        }

        [Test]
        public void TheGatewaysWordsOnARefusalAreAnEvent()
        {
            using Live live = Live.Connected();
            live.Client.Subscribe<StringMsg>("/odom");
            live.Until(
                () => live.Heard("topic /odom has type nav_msgs/msg/Odometry, not std_msgs/msg/String"), "to be refused");
        }

        [Test]
        public void AMessageOfAnotherTypeIsRefusedHere()
        {
            using Live live = Live.Connected();
            Publisher publisher = live.Client.Advertise("/typed", "std_msgs/msg/String");
            Assert.IsFalse(publisher.Publish(new TwistMsg()));
            live.Until(
                () => live.Heard("/typed: expected std_msgs/msg/String, got geometry_msgs/msg/Twist"), "for the reason");
        }

        [Test]
        public void AMessageLargerThanTheGatewayTakesIsRefusedHereAndTheConnectionStays()
        {
            using Live live = Live.Connected();
            Publisher<StringMsg> publisher = live.Client.Advertise<StringMsg>("/large");
            StringMsg large = new() { data = new string('x', 11000000) };
            live.Until(() => live.Client.RosClock.IsKnown, "for the first pong, which comes after hello");
            live.Until(() => !publisher.Publish(large), "to be refused");
            live.Until(() => live.Heard("/large: a frame of 110"), "for the reason");
            Assert.IsTrue(live.Client.IsConnected);
        }

        [Test]
        public void ASecondSubscriptionToALatchedTopicGetsTheLatchedMessageToo()
        {
            using Live live = Live.Connected();
            OccupancyGridMsg first = null;
            OccupancyGridMsg second = null;
            SubscribeOptions options = new() { Fields = new[] { "info.width" } };
            live.Client.Subscribe<OccupancyGridMsg>("/map", message => first = message, options);
            live.Until(() => first != null, "for the map");
            live.Client.Subscribe<OccupancyGridMsg>("/map", message => second = message, options);
            live.Until(() => second != null, "for the map, again");
        }

        [Test]
        public void AHandlerMayDisposeItsSubscriptionOrTheClient()
        {
            using Live live = Live.Connected();
            int seen = 0;
            Subscription<OdometryMsg> subscription = null;
            subscription = live.Client.Subscribe<OdometryMsg>("/odom", message =>
            {
                seen++;
                subscription.Dispose();
            }, new SubscribeOptions { Queue = 10 });
            live.Until(() => seen > 0, "for odometry");
            int after = 0;
            bool isDisposed = false;
            live.Client.Subscribe<OdometryMsg>("/odom", message =>
            {
                after += isDisposed ? 1 : 0;
                isDisposed = true;
                live.Client.Dispose();
                live.Client.Pump();
            }, new SubscribeOptions { Queue = 100 });
            live.Until(() => isDisposed, "for odometry, again");
            live.Client.Pump();
            Assert.AreEqual(1, seen);
            Assert.AreEqual(0, after, "a handler was called after Dispose");
        }

        [Test]
        public void AMessageThatThrowsIsRefusedAndTheConnectionStays()
        {
            using Live live = Live.Connected();
            Publisher publisher = live.Client.Advertise("/throws", "std_msgs/msg/String", new AdvertiseOptions { Latch = true });
            Assert.IsFalse(publisher.Publish(new Throwing()));
            Assert.IsFalse(publisher.Publish(null));
            live.Until(() => live.Heard("/throws: not today") && live.Heard("/throws: no message"), "for the reasons");
            Assert.IsTrue(publisher.Publish(new StringMsg { data = "tomorrow" }));
        }

        [Test]
        public void AfterDisposeNothingMoreComes()
        {
            using Live live = Live.Connected();
            int seen = 0;
            Subscription<OdometryMsg> subscription = live.Client.Subscribe<OdometryMsg>("/odom", message => seen++);
            live.Until(() => seen > 0, "for odometry");
            subscription.Dispose();
            int before = seen;
            bool isAnswered = false;
            // The answer comes after everything that was on its way.
            live.Client.Request("ping", null, reply => isAnswered = true);
            live.Until(() => isAnswered, "for an answer");
            live.Client.Pump();
            Assert.AreEqual(before, seen);
        }

        [Test]
        public void TheLastWordBeforeLeavingIsHeard()
        {
            using Live listener = Live.Connected();
            long last = 0;
            listener.Client.Subscribe<Int64Msg>("/last_words", message => last = message.data);
            for (int i = 1; i <= 20; i++)
            {
                using (Live speaker = Live.Connected())
                {
                    Publisher<Int64Msg> publisher = speaker.Client.Advertise<Int64Msg>("/last_words");
                    listener.Until(() => last == -i, "for the first word", () =>
                    {
                        publisher.Publish(new Int64Msg { data = -i });
                        listener.Client.Pump();
                    });
                    publisher.Publish(new Int64Msg { data = i });
                    publisher.Dispose();
                }
                listener.Until(() => last == i, "for the last word of " + i);
            }
        }

        [Test]
        public void WhatANetworkDoesNotTakeMakesRoomForTheNewest()
        {
            using Live live = Live.Connected(
                Live.Rogue, "/stops-reading", options => options.FreshMilliseconds = 60000);
            List<long> echoed = Echoed(live);
            Publisher publisher = Padded(live, 3);
            string padding = new('x', 50000);
            for (int i = 1; i <= 1000; i++)
            {
                Assert.IsTrue(publisher.Publish(Number(i, padding)));
            }
            live.Until(() => echoed.Contains(1000), "for the newest");
            Assert.Greater(publisher.Dropped, 0);
            Assert.IsTrue(live.Heard("/flood: "), "it was dropped in silence");
            Assert.IsTrue(live.Heard("more than 3 waited for the network"));
            CollectionAssert.IsOrdered(echoed);
        }

        [Test]
        public void WhileTheGatewayDoesNotAnswerPublishingFailsAndNothingIsSentLater()
        {
            using Live live = Live.Connected(
                Live.Rogue, "/stops-reading", options => options.FreshMilliseconds = 400);
            List<long> echoed = Echoed(live);
            Publisher publisher = Padded(live, 1);
            int number = 0;
            HashSet<long> refused = new();
            System.Action publish = () =>
            {
                number++;
                if (!publisher.Publish(Number(number, "")))
                {
                    refused.Add(number);
                }
                live.Client.Pump();
            };
            live.Until(() => refused.Count > 20, "for the stall to be noticed", publish);
            Assert.IsTrue(live.Heard("/flood: no answer from the gateway for 400 ms"));
            int stalled = number;
            live.Until(() => echoed.Exists(one => one > stalled), "for the network to be back", publish);
            int last = number;
            live.Until(() => echoed.Contains(last) || refused.Contains(last), "for the last");
            Assert.IsFalse(echoed.Exists(refused.Contains), "what was refused was sent all the same");
            Assert.IsTrue(live.Client.IsConnected);
        }

        private static List<long> Echoed(Live live)
        {
            List<long> echoed = new();
            live.Client.Subscribe(
                "/echo", Type, () => new DynamicMessage(Type),
                message => echoed.Add(message.Value["number"].AsLong()), new SubscribeOptions { Queue = 10000 });
            return echoed;
        }

        private static Publisher Padded(Live live, int queue) =>
            live.Client.Advertise("/flood", Type, new AdvertiseOptions { Queue = queue });

        private static DynamicMessage Number(int number, string padding) =>
            new DynamicMessage(Type)
            {
                Value = JsonValue.Object().With("number", number).With("padding", padding),
            };

        private sealed class Throwing : IMessage
        {
            public string RosType => "std_msgs/msg/String";

            public void Read(JsonReader reader)
            {
            }

            public void Write(JsonWriter writer) => throw new System.NotSupportedException("not today");
        }

        private static void WaitUntilHeard(Live live, Publisher<Int64Msg> publisher, Subscription<Int64Msg> subscription)
        {
            // ROS drops what is published before publisher and subscriber have found each other.
            live.Until(() => subscription.Received > 0, "for the first", () =>
            {
                publisher.Publish(new Int64Msg { data = 0 });
                live.Client.Pump();
            });
            Subscription<Int64Msg> last = live.Client.Subscribe<Int64Msg>("/numbers");
            Int64Msg message = null;
            publisher.Publish(new Int64Msg { data = -1 });
            live.Until(() => last.TryTake(out message) && message.data == -1, "for the last of these");
            last.Dispose();
        }

        /// <summary>As many as after which what has come is no longer new.</summary>
        private static void LetFramesPass(Live live)
        {
            live.Client.Pump();
            live.Client.Pump();
            live.Client.Pump();
        }

        private static List<long> Empty(Subscription<Int64Msg> subscription)
        {
            List<long> numbers = new();
            Int64Msg message;
            while (subscription.TryTake(out message))
            {
                numbers.Add(message.data);
            }
            return numbers;
        }

        private static List<long> Numbers(long from, long to)
        {
            List<long> numbers = new();
            for (long i = from; i <= to; i++)
            {
                numbers.Add(i);
            }
            return numbers;
        }
    }
}
