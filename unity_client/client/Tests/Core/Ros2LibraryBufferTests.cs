// SPDX-License-Identifier: Apache-2.0
using System;
using System.Text;
using NUnit.Framework;
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Messages.SensorMsgs;
using Ros2Gateway.Messages.StdMsgs;
using static Ros2Gateway.Tests.LibraryTopic;
using static Ros2Gateway.Thesis.Ros2Library;

namespace Ros2Gateway.Tests
{
    /// <summary>The library of 2021 as its programs call it: values and buffers instead of messages.</summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class Ros2LibraryBufferTests
    {
        private const int String = 0;

        [SetUp]
        public void SetUp() => Thesis.Ros2Library.Options = new GatewayOptions { Address = Live.Address(Live.Gateway) };

        [TearDown]
        public void TearDown() => ros2_shutdown();

        [Test]
        public void AProgramOf2021RunsAsItIs()
        {
            ProgramOf2021 program = new();
            Assert.IsTrue(program.Start());
            Assert.IsTrue(add_subscriber("/old/pose", 4, 10, 10));
            Assert.IsTrue(add_subscriber("/old/pose_with_cov", 3, 10, 10));
            PoseStampedMsg pose = null;
            PoseWithCovarianceStampedMsg withCovariance = null;
            Until(ros2_ok, "to be connected");
            Until(() => program.HasEverything && pose != null && withCovariance != null, "for all", () =>
            {
                program.Send();
                program.Update();
                pose ??= Polled<PoseStampedMsg>("/old/pose");
                withCovariance ??= Polled<PoseWithCovarianceStampedMsg>("/old/pose_with_cov");
            });

            Assert.AreEqual("hello robot", program.Text.ToString());
            CollectionAssert.AreEqual(
                new[] { 0.1, 0.2, 0.3, 0.4, 0.5, 0.6 },
                new[] { program.X, program.Y, program.Z, program.Rx, program.Ry, program.Rz });
            Assert.AreEqual(12345, program.Sec);
            Assert.AreEqual(678, program.Nanosec);
            string frame;
            Until(() => ZeroStampOf("/old/header", out frame) && frame == "zero", "for a stamp of 0", () =>
            {
                send_header("/old/header", 0, 0, "zero");
            });
            Assert.AreEqual(12345, pose.header.stamp.sec);
            Assert.AreEqual(678, pose.header.stamp.nanosec);
            Assert.AreEqual("map", pose.header.frame_id);
            Assert.AreEqual(3, pose.pose.position.z);
            Assert.AreEqual(0.6, pose.pose.orientation.z);
            Assert.AreEqual(0.8, pose.pose.orientation.w);
            Assert.AreEqual(2, withCovariance.pose.pose.position.y);
            Assert.AreEqual(0.5, withCovariance.pose.covariance[35]);
            Assert.Greater(program.Voltage, 0);
            Assert.IsTrue(program.Present);
            Assert.AreEqual("base_footprint", program.ChildFrameId.ToString());
            Assert.AreEqual(1, Math.Sqrt(program.QuatZ * program.QuatZ + program.QuatW * program.QuatW), 1e-6);
            Assert.Greater(program.Covariance[0], 0);
            Assert.AreEqual(program.Step * program.Height, program.ImageSize);
            Assert.AreEqual("rgb8", program.Encoding.ToString());
            Assert.AreEqual(0xFF, program.Picture[0]);
            Assert.AreEqual(0xD8, program.Picture[1]);
            StringAssert.Contains("jpeg", program.Format.ToString());
            Assert.Greater(program.RangesSize, 0);
            Assert.AreEqual(program.AngleMax, program.AngleMin + (program.RangesSize - 1) * program.AngleIncrement, 0.1);
            program.OnDestroy();
            Assert.IsFalse(ros2_ok());
        }

        [Test]
        public void AProgramWithBytesAndOtherSizesRunsToo()
        {
            AnotherProgramOf2021 program = new();
            Assert.IsTrue(program.Start());
            Until(ros2_ok, "to be connected");
            Until(() => program.HasEverything, "for all", () =>
            {
                program.Send();
                program.Update();
            });
            Assert.AreEqual("hello robot", program.Text);
            Assert.AreEqual("rgb8", program.Encoding);
            Assert.AreEqual("base_footprint", program.ChildFrameId);
            StringAssert.Contains("jpeg", program.Format);
            Assert.Greater(program.ImageSize.ToUInt64(), 0);
            Assert.Greater(program.PictureSize.ToUInt64(), 0);
            Assert.Greater(program.RangesSize, 0);
            Assert.Greater(program.Voltage, 0);
            Assert.AreNotEqual(0, program.QuatW);
            Assert.AreEqual(UIntPtr.Zero, program.CellAmount);
        }

        [Test]
        public void ATextThatDoesNotFitIsCutBeforeACharacterAndADebugMessageSaysSo()
        {
            const string Words = "größer"; // 6 letters in 8 bytes
            Waiting("/narrow", Words);
            StringBuilder text = new("before");
            uint size = 3; // ends inside of the third letter
            Assert.IsTrue(poll_string("/narrow", text, ref size));
            Assert.AreEqual(2, size);
            Assert.AreEqual("gr", text.ToString());
            Assert.IsTrue(Told("poll_string /narrow: buffer got 2 of 8 bytes: the text is cut, pass a larger buffer"));
            Assert.IsFalse(poll_string("/narrow", text, ref size), "it is taken");
            Assert.AreEqual(0, size);
            byte[] bytes = { 1, 2, 3, 4, 5, 6, 7 };
            Assert.AreEqual(7, PolledAgain("/narrow", Words, bytes, ulong.MaxValue), "more than the array has");
            Assert.AreEqual("größe", Encoding.UTF8.GetString(bytes));
            Assert.AreEqual(0, PolledAgain("/narrow", Words, null, -1));
        }

        [Test]
        public void ATextThatFitsIsWholeWhateverItsSizeWasDeclaredAs()
        {
            byte[] bytes = { 1, 2, 3, 4, 5, 6, 7, 8, 9, 10 };
            Waiting("/fits", "");
            Assert.IsTrue(LibraryTopic.PollText("/fits", out string text));
            Assert.AreEqual(8u, PolledAgain("/fits", "größer", bytes, 8u));
            Assert.AreEqual("größer", Encoding.UTF8.GetString(bytes, 0, 8));
            Assert.AreEqual(0, bytes[8], "ends as in C");
            Assert.AreEqual(10, bytes[9]);
            Assert.AreEqual(8, PolledAgain("/fits", "größer", bytes, 8));
            Assert.AreEqual(8ul, PolledAgain("/fits", "größer", bytes, 8ul));
            Assert.AreEqual(new UIntPtr(8), PolledAgain("/fits", "größer", bytes, new UIntPtr(8)));
            while (poll_debug_message(out text)) // on a slow machine, about markers that were dropped
            {
                Assert.IsFalse(text.Contains("is cut"), text);
            }
        }

        [Test]
        public void AScanThatDoesNotFitStaysWhole()
        {
            Connect();
            LaserScanMsg sent = new() { ranges = new[] { 1f, float.PositiveInfinity, 3f } };
            sent.header.frame_id = "laser";
            Pair("/small_scan", 7);
            Waiting("/small_scan", sent);
            uint sec = 7;
            uint nanosec = 7;
            StringBuilder frame = new();
            float f = 7;
            float[] ranges = new float[3];
            uint frameSize = 64;
            uint count = 2;
            uint none = 0;
            Assert.IsFalse(poll_laser_scan(
                "/small_scan", ref sec, ref nanosec, frame, ref frameSize, ref f, ref f, ref f, ref f, ref f, ref f, ref f,
                ranges, ref count, null, ref none));
            Assert.AreEqual(0, frame.Length, "nothing is written");
            Assert.AreEqual(7, f);
            Assert.AreEqual(0, frameSize);
            Assert.AreEqual(0, count);
            Assert.IsTrue(Told("poll_laser_scan /small_scan: ranges needs 3 elements, has 2: the message stays, pass a larger buffer"));
            frameSize = 64;
            count = 3;
            Assert.IsTrue(poll_laser_scan(
                "/small_scan", ref sec, ref nanosec, frame, ref frameSize, ref f, ref f, ref f, ref f, ref f, ref f, ref f,
                ranges, ref count, null, ref none));
            Assert.AreEqual("laser", frame.ToString());
            Assert.AreEqual(5, frameSize);
            Assert.AreEqual(3, count);
            CollectionAssert.AreEqual(sent.ranges, ranges);
        }

        [TestCase(0u, 0u)]
        [TestCase(3u, 3u)]
        public void CellsOfABatteryAreWrittenUnlessNoneAreAskedFor(uint room, uint written)
        {
            Connect();
            BatteryStateMsg sent = new()
            {
                cell_voltage = new[] { 3.7f, 3.6f, 3.5f },
                cell_temperature = new[] { 20f },
                location = "hull",
                serial_number = "n 1",
            };
            Pair("/cells", 6);
            Waiting("/cells", sent);
            uint sec = 0;
            uint nanosec = 0;
            uint frameSize = 0; // an empty text takes none
            uint locationSize = 4;
            uint serialSize = 3;
            StringBuilder frame = new();
            StringBuilder location = new();
            StringBuilder serial = new();
            float f = 0;
            byte b = 0;
            bool present = true;
            float[] volts = new float[3];
            float[] degrees = new float[3];
            uint cells = room;
            Assert.IsTrue(poll_battery_state(
                "/cells", ref sec, ref nanosec, frame, ref frameSize, ref f, ref f, ref f, ref f, ref f, ref f, ref f,
                ref b, ref b, ref b, ref present, volts, degrees, ref cells, location, ref locationSize,
                serial, ref serialSize));
            Assert.AreEqual(written, cells);
            Assert.AreEqual("hull", location.ToString());
            Assert.AreEqual("n 1", serial.ToString());
            Assert.IsFalse(present);
            Assert.AreEqual(written == 0 ? 0f : 3.5f, volts[2]);
            Assert.AreEqual(written == 0 ? 0f : 20f, degrees[0]);
            Assert.AreEqual(written == 0 ? 0f : float.NaN, degrees[2]);
        }

        [Test]
        public void APollOfAnotherTypeLeavesTheMessageWhereItIs()
        {
            Waiting("/wrong_type", "still here");
            double d = 0;
            uint u = 0;
            byte[] frame = new byte[9];
            Assert.IsFalse(poll_twist("/wrong_type", ref d, ref d, ref d, ref d, ref d, ref d));
            Assert.IsTrue(Told("poll_twist /wrong_type: the subscriber has type std_msgs/msg/String"));
            Assert.IsFalse(poll_header("/wrong_type", ref u, ref u, frame, ref u));
            Assert.IsNull(Polled<PoseStampedMsg>("/wrong_type"));
            Assert.IsTrue(LibraryTopic.PollText("/wrong_type", out string text));
            Assert.AreEqual("still here", text);
        }

        [Test]
        public void ASecondPublisherOnATopicIsRefusedAndTheFirstGoesOn()
        {
            Waiting("/used", "first");
            uint twist = 1;
            Assert.IsFalse(add_publisher("/used", twist, 10));
            Assert.IsFalse(add_publisher("/used", String, 10));
            Assert.IsTrue(Told("add_publisher /used: the topic has a publisher already"));
            Assert.IsTrue(send_string("/used", "still"));
            string text = "";
            Until(() => LibraryTopic.PollText("/used", out text) && text == "still", "for the second text");
        }

        [Test]
        public void WhatROSCannotHoldIsNotSentAndADebugMessageSaysWhy()
        {
            Connect();
            Assert.IsTrue(add_publisher("/late", 2, 10));
            Assert.IsTrue(add_publisher("/covariance", 3, 10));
            Assert.IsFalse(send_header("/late", 3000000000, 0, "map"));
            Assert.IsTrue(Told("send_header /late: sec is 3000000000, at most 2147483647 in ROS"));
            Assert.IsFalse(send_pose_with_cov("/covariance", 1, 2, "map", 0, 0, 0, 0, 0, 0, 1, new double[6]));
            Assert.IsTrue(Told("send_pose_with_cov /covariance: covariance has 6 values, expected 36"));
        }

        [TestCase("ros2_gateway", false)]
        [TestCase("nobodys_prefix", true)]
        public void APrefixThatTheNodesDoNotHaveIsTold(string prefix, bool isTold)
        {
            Assert.IsTrue(ros2_init(prefix));
            bool isHeard = false;
            Assert.IsTrue(add_publisher("/prefix", String, 10));
            Assert.IsTrue(add_subscriber("/prefix", String, 10, 10));
            // The graph was asked for with the connection, and is there before what is sent comes back.
            string text;
            Until(() => LibraryTopic.PollText("/prefix", out text), "for a text", () => send_string("/prefix", "x"));
            while (poll_debug_message(out text))
            {
                isHeard |= text.Contains("--node-prefix " + prefix);
            }
            Assert.AreEqual(isTold, isHeard);
        }

        /// <summary>Sends a text, and polls it when it comes. Returns its size.</summary>
        private static T PolledAgain<T>(string topic, string text, byte[] bytes, T room)
            where T : struct
        {
            T size = room;
            Assert.IsTrue(send_string(topic, text));
            Until(() => poll_string(topic, bytes, ref size), "for the text", () => size = room);
            return size;
        }

        private static void Connect()
        {
            Assert.IsTrue(ros2_init());
            Until(ros2_ok, "to be connected");
        }

        /// <summary>A publisher and a subscriber, found by each other.</summary>
        private static void Pair(string topic, int type)
        {
            Assert.IsTrue(add_publisher(topic, type, 10));
            Assert.IsTrue(add_subscriber(topic, type, 10, 10));
        }

        /// <summary>Connects, and has one text wait to be polled.</summary>
        private static void Waiting(string topic, string text)
        {
            Connect();
            Pair(topic, String);
            Waiting(topic, new Messages.StdMsgs.StringMsg { data = text });
        }

        /// <summary>Has exactly one message wait: it is sent until one has come, and what is more is taken.</summary>
        private static void Waiting(string topic, IMessage message)
        {
            LibraryTopic.Settle(topic, message);
            Assert.IsTrue(send(topic, message));
            string marker = topic + "_marker";
            Pair(marker, String);
            string text;
            for (int i = 0; i < 3; i++)
            {
                // There and back again some times: whatever was sent before has long come.
                Until(() => LibraryTopic.PollText(marker, out text), "for the marker", () => send_string(marker, "x"));
            }
            while (poll_debug_message(out text))
            {
            }
        }

        private static bool ZeroStampOf(string topic, out string frame)
        {
            bool isThere = poll(topic, out HeaderMsg header);
            frame = isThere ? header.frame_id : "";
            return isThere && header.stamp.sec == 0 && header.stamp.nanosec == 0;
        }

        private static T Polled<T>(string topic)
            where T : class, IMessage =>
            poll(topic, out T message) ? message : null;

        private static bool Told(string words)
        {
            bool isTold = false;
            string text;
            while (poll_debug_message(out text))
            {
                isTold |= text == words;
            }
            return isTold;
        }
    }
}
