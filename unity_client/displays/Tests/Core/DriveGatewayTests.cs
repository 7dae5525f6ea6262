// SPDX-License-Identifier: Apache-2.0
using System;
using NUnit.Framework;
using Ros2Gateway.Drive;
using Ros2Gateway.Json;
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Messages.NavMsgs;

namespace Ros2Gateway.Tests
{
    /// <summary>Driving the simulated robot through a live gateway: where it gets to, and how driving ends.</summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class DriveGatewayTests
    {
        private const double Standing = 1e-3; // m/s and rad/s

        // A third of a minute each, at the robot's pace: twenty targets in all, four of them ahead of time.
        [Category("Long")]
#if ENABLE_IL2CPP
        [TestCase(5)]
#else
        [TestCase(1)]
        [TestCase(2)]
        [TestCase(3)]
        [TestCase(4)]
#endif
        public void FourRandomTargetsAreReachedWithinFiveCentimetres(int seed)
        {
            using Live live = Live.Connected();
            var robot = new GatewayRobot(live);
            robot.Reset();
            var settings = new DriveSettings();
            var drive = new DriveToTarget(settings);
            var random = new Random(seed);
            for (int i = 0; i < 4; i++)
            {
                // Between the crates and the pillars: from anywhere in here to anywhere nothing is in the
                // way.
                double x = -0.4 + 0.9 * random.NextDouble(), y = -0.4 + 0.8 * random.NextDouble();
                DriveState end = DriveLoop.Run(drive, settings, robot, x, y);
                Assert.AreEqual(DriveState.Done, end, drive.Reason);
                PlanarPose rest = robot.Pose;
                double miss = Math.Sqrt((rest.x - x) * (rest.x - x) + (rest.y - y) * (rest.y - y));
                Assert.Less(miss, 0.05);
            }
        }

        [TestCase(11)]
#if !ENABLE_IL2CPP // at the robot's pace: ahead of time one says enough
        [TestCase(12)]
        [TestCase(13)]
#endif
        public void InTheRoomTooATargetIsReachedWithinFiveCentimetres(int seed)
        {
            using Live live = Live.Connected();
            var robot = new GatewayRobot(live);
            robot.Reset(); // odometry and room agree there, and drift apart by a centimetre a metre
            var random = new Random(seed);
            double x = -0.4 + 0.9 * random.NextDouble(), y = -0.4 + 0.8 * random.NextDouble();
            var settings = new DriveSettings();
            var drive = new DriveToTarget(settings);
            Assert.AreEqual(DriveState.Done, DriveLoop.Run(drive, settings, robot, x, y), drive.Reason);
            PlanarPose truth = Truth(live);
            Assert.Less(Math.Sqrt((truth.x - x) * (truth.x - x) + (truth.y - y) * (truth.y - y)), 0.05);
        }

        [Test]
        public void AStopIsPublishedAndTheRobotStands()
        {
            using (Live live = Live.Connected())
            using (Live other = Live.Connected())
            {
                TwistMsg heard = null;
                OdometryMsg odometry = null;
                other.Client.Subscribe<TwistMsg>("/cmd_vel", twist => heard = twist);
                other.Client.Subscribe<OdometryMsg>("/odom", message => odometry = message);
                var robot = new GatewayRobot(live);
                robot.Reset();
                var settings = new DriveSettings();
                var drive = new DriveToTarget(settings);
                drive.SetTarget(0.5, 0, robot.Now);
                Func<bool> drives = () =>
                    heard != null && heard.linear.x > 0.1 && odometry.twist.twist.linear.x > 0.1;
                other.Until(drives, "to drive", () =>
                {
                    DriveLoop.Step(drive, settings, robot);
                    other.Client.Pump();
                });
                drive.Stop("enough");
                Assert.AreEqual(DriveCommand.Zero, DriveLoop.Step(drive, settings, robot));
                other.Until(() => heard.linear.x == 0 && heard.angular.z == 0, "for zero");
                other.Until(() => Stands(odometry), "for the robot to stand");
            }
        }

        [Test]
        public void ALineThatIsCutStopsTheRobotAndANewOneResumesNothing()
        {
            using (Live other = Live.Connected())
            using (Live live = Live.Connected(Live.Rogue, "/through", o => o.FirstPauseMilliseconds = 1000))
            {
                OdometryMsg odometry = null;
                other.Client.Subscribe<OdometryMsg>("/odom", message => odometry = message);
                var robot = new GatewayRobot(live);
                robot.Reset();
                var settings = new DriveSettings();
                var drive = new DriveToTarget(settings);
                // as a scene does
                live.Client.StateChanged += state => drive.Stop("connection lost");
                drive.SetTarget(0.5, 0, robot.Now);
                other.Until(() => odometry != null && odometry.twist.twist.linear.x > 0.1, "to drive", () =>
                {
                    DriveLoop.Step(drive, settings, robot);
                    other.Client.Pump();
                });
                int states = live.States.Count;
                live.Client.Request("cut", null, null);
                live.Until(() => live.States.Count > states, "for the cut");
                other.Until(() => Stands(odometry), "for the robot to stand by itself");
                double x = odometry.pose.pose.position.x;
                live.Until(() => live.Client.IsConnected, "to be connected again");
                double until = robot.Now + 1;
                while (robot.Now < until)
                {
                    Assert.AreEqual(DriveCommand.Zero, DriveLoop.Step(drive, settings, robot));
                    other.Client.Pump();
                }
                Assert.AreEqual("connection lost", drive.Reason);
                Assert.IsTrue(Stands(odometry));
                Assert.AreEqual(x, odometry.pose.pose.position.x, 0.005);
            }
        }

        private static bool Stands(OdometryMsg odometry) =>
            Math.Abs(odometry.twist.twist.linear.x) < Standing
                && Math.Abs(odometry.twist.twist.angular.z) < Standing;

        /// <summary>The place of the robot in its room, by the simulation.</summary>
        private static PlanarPose Truth(Live live)
        {
            Reply<JsonValue>? reply = null;
            live.Client.Request(
                "lookup_transform",
                JsonValue.Parse(
                    "{\"target_frame\":\"map\",\"source_frame\":\"base_footprint\",\"timeout\":5}"),
                got => reply = got);
            live.Until(() => reply.HasValue, "for the robot's place in its room");
            if (!reply.Value.Ok && reply.Value.Error.Contains("need package"))
            {
                Assert.Ignore("gateway: " + reply.Value.Error);
            }
            JsonReader reader = new();
            byte[] json = System.Text.Encoding.UTF8.GetBytes(reply.Value.OrThrow()["transform"].ToString());
            reader.Reset(json, 0, json.Length);
            TransformStampedMsg transform = new();
            transform.Read(reader);
            return new PlanarPose(transform.transform.As<Flu>());
        }
    }
}
