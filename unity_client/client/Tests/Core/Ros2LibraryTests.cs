// SPDX-License-Identifier: Apache-2.0
using System.Threading;
using NUnit.Framework;
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Messages.NavMsgs;
using Ros2Gateway.Messages.SensorMsgs;
using Ros2Gateway.Messages.StdMsgs;
using static Ros2Gateway.Tests.LibraryTopic;
using static Ros2Gateway.Thesis.Ros2Library;

namespace Ros2Gateway.Tests
{
    /// <summary>The calls of the library of 2021, tested as that was: base tests, five messages, five topics.</summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class Ros2LibraryTests
    {
        private const int String = 0;
        private const int Twist = 1;
        private const int Header = 2;
        private const int PoseWithCovariance = 3;
        private const int Pose = 4;
        private const int Image = 5;
        private const int BatteryState = 6;
        private const int LaserScan = 7;
        private const int CompressedImage = 8;
        private const int Odometry = 9;

        [SetUp]
        public void SetUp() => Thesis.Ros2Library.Options = new GatewayOptions { Address = Live.Address(Live.Gateway) };

        [TearDown]
        public void TearDown() => ros2_shutdown();

        [Test]
        public void InitAndShutdownInAnyOrderAreHarmless()
        {
            ros2_shutdown();
            Assert.IsTrue(ros2_init("a"));
            Assert.IsTrue(ros2_init("b"));
            ros2_shutdown();
            ros2_shutdown();
            Assert.IsFalse(ros2_ok());
            for (int i = 0; i < 5; i++)
            {
                Assert.IsTrue(ros2_init("again"));
                ros2_shutdown();
            }
            Connect();
            ros2_shutdown();
            Connect();
        }

        [Test]
        public void BeforeInitEverythingFailsAndNothingThrows()
        {
            string text;
            Assert.IsFalse(add_publisher("/t", String, 10));
            Assert.IsFalse(add_subscriber("/t", String, 10, 10));
            Assert.IsFalse(send_string("/t", "x"));
            Assert.IsFalse(LibraryTopic.PollText("/t", out text));
            Assert.AreEqual("", text);
            Assert.IsFalse(ros2_ok());
        }

        [Test]
        public void SendingAndPollingWithoutRegistrationFailAndNothingThrows()
        {
            Connect();
            string text;
            TwistMsg twist;
            HeaderMsg header;
            ImageMsg image;
            CompressedImageMsg compressed;
            BatteryStateMsg battery;
            LaserScanMsg scan;
            OdometryMsg odometry;
            Assert.IsFalse(send_string("/t", "x"));
            Assert.IsFalse(send_twist("/t", 1, 0, 0, 0, 0, 0));
            Assert.IsFalse(send("/t", new HeaderMsg()));
            Assert.IsFalse(send("/t", new PoseStampedMsg()));
            Assert.IsFalse(send("/t", new PoseWithCovarianceStampedMsg()));
            Assert.IsFalse(LibraryTopic.PollText("/t", out text));
            Assert.IsFalse(poll("/t", out twist));
            Assert.IsFalse(poll("/t", out header));
            Assert.IsFalse(poll("/t", out image));
            Assert.IsFalse(poll("/t", out compressed));
            Assert.IsFalse(poll("/t", out battery));
            Assert.IsFalse(poll("/t", out scan));
            Assert.IsFalse(poll("/t", out odometry));
            Assert.IsTrue(poll_debug_message(out string debug));
            Assert.IsFalse(add_publisher("/t", 9999, 10));
            Assert.IsFalse(add_subscriber("/t", -1, 10, 10));
            Assert.IsFalse(add_publisher("", String, 10));
        }

        [Test]
        public void AVelocityThatTheGatewayRefusesIsToldByADebugMessage()
        {
            Connect();
            Assert.IsTrue(add_publisher("/cmd_vel", Twist, 1));
            Assert.IsTrue(add_subscriber("/odom", Odometry, 1, 1));
            OdometryMsg odometry = null;
            Until(() => Speed(ref odometry) > 0.04, "to drive", Push);
            Until(() => Speed(ref odometry) < 0.001, "for the gateway to stop a robot that nobody commands");
            string said = "";
            // again and again: on a slow machine an overdue pong may have been the first reason
            Until(
                () => poll_debug_message(out said) && said.Contains("stopped"),
                "for the reason",
                () => send_twist("/cmd_vel", 0.05, 0, 0, 0, 0, 0));
            Until(() => send_twist("/cmd_vel", 0, 0, 0, 0, 0, 0), "to stop");
            Until(() => Speed(ref odometry) > 0.04, "to drive again", Push);
            Assert.IsTrue(send_twist("/cmd_vel", 0, 0, 0, 0, 0, 0));
        }

        [Test]
        public void FiveMessagesArriveInOrder()
        {
            Connect();
            LibraryTopic.Open("/five", String);
            for (int i = 0; i < 5; i++)
            {
                Assert.IsTrue(send_string("/five", "message " + i));
            }
            for (int i = 0; i < 5; i++)
            {
                string text = "";
                Until(() => LibraryTopic.PollText("/five", out text), "for message " + i);
                Assert.AreEqual("message " + i, text);
            }
        }

        [Test]
        public void OnlyAsManyAsTheBacklogWaitAndTheyAreTheNewest()
        {
            Connect();
            LibraryTopic.Open("/backlog", String, 3);
            LibraryTopic.Open("/marker", String);
            for (int i = 0; i < 10; i++)
            {
                Assert.IsTrue(send_string("/backlog", i.ToString()));
            }
            string text = "";
            for (int i = 0; i < 3; i++)
            {
                // There and back again some times: whatever was sent before has long come.
                Assert.IsTrue(send_string("/marker", "marker"));
                Until(() => LibraryTopic.PollText("/marker", out text), "for the marker");
            }
            for (int i = 7; i < 10; i++)
            {
                Assert.IsTrue(LibraryTopic.PollText("/backlog", out text));
                Assert.AreEqual(i.ToString(), text);
            }
            Assert.IsFalse(LibraryTopic.PollText("/backlog", out text));
        }

        [Test]
        public void FiveTopicsAtOnceWithFiveTypes()
        {
            Connect();
            LibraryTopic.Open("/one", String);
            LibraryTopic.Open("/two", Twist);
            LibraryTopic.Open("/three", Header);
            LibraryTopic.Open("/four", PoseWithCovariance);
            LibraryTopic.Open("/five_b", Pose);
            string text = "";
            TwistMsg twist = null;
            HeaderMsg header = null;
            PoseWithCovarianceStampedMsg withCovariance = null;
            PoseStampedMsg pose = null;
            PoseWithCovarianceStampedMsg sent = new();
            sent.pose.covariance[35] = 0.5;
            Assert.IsTrue(send_string("/one", "1"));
            Assert.IsTrue(send_twist("/two", 0.26, 0, 0, 0, 0, 1.82));
            Assert.IsTrue(send("/three", new HeaderMsg { frame_id = "map" }));
            Assert.IsTrue(send("/four", sent));
            PoseStampedMsg goal = new();
            goal.pose.position.x = 1.5;
            Assert.IsTrue(send("/five_b", goal));
            Until(() => LibraryTopic.PollText("/one", out text), "for the string");
            Until(() => poll("/two", out twist), "for the twist");
            Until(() => poll("/three", out header), "for the header");
            Until(() => poll("/four", out withCovariance), "for the pose with covariance");
            Until(() => poll("/five_b", out pose), "for the pose");
            Assert.AreEqual("1", text);
            Assert.AreEqual(1.82, twist.angular.z);
            Assert.AreEqual("map", header.frame_id);
            Assert.Greater(header.stamp.sec, 0, "a header without a stamp is stamped");
            Assert.AreEqual(0.5, withCovariance.pose.covariance[35]);
            Assert.AreEqual(1.5, pose.pose.position.x);
        }

        [Test]
        public void EverythingThatTheRobotSensesCanBePolled()
        {
            Connect();
            ImageMsg image = null;
            CompressedImageMsg compressed = null;
            BatteryStateMsg battery = null;
            LaserScanMsg scan = null;
            OdometryMsg odometry = null;
            Assert.IsTrue(add_subscriber("/camera/image_raw", Image, 1, 1));
            Assert.IsTrue(add_subscriber("/camera/image_raw/compressed", CompressedImage, 1, 1));
            Assert.IsTrue(add_subscriber("/battery_state", BatteryState, 10, 10));
            Assert.IsTrue(add_subscriber("/scan", LaserScan, 10, 10));
            Assert.IsTrue(add_subscriber("/odom", Odometry, 10, 10));
            Until(() => poll("/camera/image_raw", out image), "for the image");
            Until(() => poll("/camera/image_raw/compressed", out compressed), "for the picture");
            Until(() => poll("/battery_state", out battery), "for the battery");
            Until(() => poll("/scan", out scan), "for the scan");
            Until(() => poll("/odom", out odometry), "for odometry");
            Assert.AreEqual(image.step * image.height, image.data.Length);
            Assert.AreEqual(0xFF, compressed.data[0]);
            Assert.Greater(battery.voltage, 0);
            Assert.Greater(scan.ranges.Length, 0);
            Assert.AreEqual(36, odometry.pose.covariance.Length);
        }

        [Test]
        public void PollingAnotherTypeThanWasSubscribedFails()
        {
            Connect();
            Assert.IsTrue(add_subscriber("/odom", Odometry, 10, 10));
            TwistMsg twist;
            string words = "";
            Until(() => !poll("/odom", out twist) && poll_debug_message(out words) && words.Contains("has type"), "for the words");
            StringAssert.Contains("the subscriber has type nav_msgs/msg/Odometry", words);
        }

        /// <summary>Drives as a stick does, which is let go of when the robot does not move.</summary>
        // A robot that was stopped takes commands after a zero, and 0.25 s in which nothing moves it.
        private static void Push()
        {
            send_twist("/cmd_vel", 0, 0, 0, 0, 0, 0);
            Thread.Sleep(300);
            for (int i = 0; i < 50; i++)
            {
                send_twist("/cmd_vel", 0.05, 0, 0, 0, 0, 0);
                Thread.Sleep(20);
            }
        }

        private static double Speed(ref OdometryMsg newest)
        {
            newest = poll("/odom", out OdometryMsg odometry) ? odometry : newest;
            return newest == null ? double.NaN : newest.twist.twist.linear.x;
        }

        private static void Connect()
        {
            Assert.IsTrue(ros2_init("unity"));
            Until(ros2_ok, "to be connected");
        }
    }
}
