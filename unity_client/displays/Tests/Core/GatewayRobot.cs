// SPDX-License-Identifier: Apache-2.0
using System;
using System.Diagnostics;
using System.Threading;
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
        private readonly RobotControl _control;
        private readonly TwistMsg _twist = new();
        private PlanarPose _pose;
        private double _poseTime = double.NaN;

        internal GatewayRobot(Live live)
        {
            _live = live;
            _control = live.Client.Control();
            _commands = live.Client.Advertise<TwistMsg>("/cmd_vel");
            live.Client.Subscribe<OdometryMsg>("/odom", Take);
        }

        public double Now => _clock.Elapsed.TotalSeconds;

        public PlanarPose Pose => _pose;

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
            // Another test may have left the robot stopped.
            _live.Until(() => _control.State.IsKnown && _commands.Refusal == null, "for the latch to be reset", () =>
            {
                _commands.Publish(new TwistMsg());
                _live.Client.Pump();
                Thread.Sleep(PeriodMilliseconds);
            });
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
}
