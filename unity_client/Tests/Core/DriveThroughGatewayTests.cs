// SPDX-License-Identifier: Apache-2.0
using System;
using System.Diagnostics;
using System.Threading;
using NUnit.Framework;
using Ros2Gateway.Drive;
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Messages.NavMsgs;
using Ros2Gateway.Messages.StdSrvs;

namespace Ros2Gateway.Tests
{
    /// <summary>The simulated robot behind a live gateway, driven by its odometry as a scene does.</summary>
    internal sealed class GatewayRobot : IDrivenRobot
    {
        private const int PeriodMilliseconds = 50;

        private readonly Stopwatch _clock = Stopwatch.StartNew();
        private readonly Live _live;
        private readonly Publisher<TwistMsg> _commands;
        private readonly TwistMsg _twist = new TwistMsg();
        private PlanarPose _pose;
        private double _poseTime = double.NaN;

        internal GatewayRobot(Live live)
        {
            _live = live;
            _commands = live.Client.Advertise<TwistMsg>("/cmd_vel");
            live.Client.Subscribe<OdometryMsg>("/odom", Take);
        }

        public double Now
        {
            get { return _clock.Elapsed.TotalSeconds; }
        }

        public PlanarPose Pose
        {
            get { return _pose; }
        }

        public bool TryGetPose(out PlanarPose pose, out double time)
        {
            pose = _pose;
            time = _poseTime;
            return !double.IsNaN(time);
        }

        public void Command(DriveCommand command)
        {
            _twist.linear.x = command.linear;
            _twist.angular.z = command.angular;
            _commands.Publish(_twist);
        }

        public void Wait()
        {
            Stopwatch period = Stopwatch.StartNew();
            while (period.ElapsedMilliseconds < PeriodMilliseconds)
            {
                _live.Client.Pump();
                Thread.Sleep(2);
            }
        }

        internal void Reset()
        {
            bool isDone = false;
            _live.Client.CallService<TriggerResponse>(
                "/reset", new TriggerRequest(), reply => isDone = true);
            _live.Until(() => isDone, "for an answer of /reset");
            _poseTime = double.NaN;
            _live.Until(
                () => !double.IsNaN(_poseTime) && Math.Abs(_pose.x) + Math.Abs(_pose.y) < 0.01,
                "to be back at the start");
        }

        private void Take(OdometryMsg odometry)
        {
            _pose = new PlanarPose(odometry.pose.pose.As<Flu>());
            _poseTime = Now;
        }
    }

    [TestFixture]
    [Category("Gateway")]
    public sealed class DriveThroughGatewayTests
    {
        // A third of a minute each, at the robot's pace: twenty targets in all, four of them ahead of time.
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
            using (Live live = Live.Connected())
            {
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
        }
    }
}
