// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using Ros2Gateway.Drive;

namespace Ros2Gateway.Tests
{
    /// <summary>
    /// A base with two driven wheels in its own time: limited accelerations, odometry that is late, noisy
    /// and comes at 30 Hz, commands that are late too.
    /// </summary>
    public sealed class SimulatedBase : IDrivenRobot
    {
        private const double Tick = 0.01;
        private const int ControlTicks = 5; // 20 Hz
        private const double OdometryPeriod = 1.0 / 30;
        private const double LinearAcceleration = 1.0; // m/s^2
        private const double AngularAcceleration = 8.0; // rad/s^2

        private readonly Random _random;
        private readonly double _delay;
        private readonly double _noise;
        private readonly Queue<KeyValuePair<double, DriveCommand>> _commands =
            new();
        private readonly Queue<KeyValuePair<double, PlanarPose>> _poses =
            new();
        private DriveCommand _command;
        private PlanarPose _seen;
        private double _seenTime = double.NaN;
        private double _nextOdometry;
        private double _linear;
        private double _angular;

        /// <summary>
        /// A base at the origin. The delay in seconds each way, the noise in metres and radians.
        /// </summary>
        public SimulatedBase(int seed, double delay, double noise)
        {
            _random = new Random(seed);
            _delay = delay;
            _noise = noise;
            Now = 1000;
        }

        public double Now { get; private set; }

        public PlanarPose Truth { get; set; }

        public bool HasOdometry { get; set; } = true;

        public bool IsBlocked { get; set; }

        public double Turned { get; private set; }

        public double Distance(double x, double y) => Math.Sqrt((Truth.x - x) * (Truth.x - x) + (Truth.y - y) * (Truth.y - y));

        public bool TryGetPose(out PlanarPose pose, out double time)
        {
            pose = _seen;
            time = _seenTime;
            return !double.IsNaN(time);
        }

        public void Command(DriveCommand command) =>
            _commands.Enqueue(new KeyValuePair<double, DriveCommand>(Now + _delay, command));

        public void Wait()
        {
            for (int i = 0; i < ControlTicks; i++)
            {
                Move();
            }
        }

        private void Move()
        {
            Now += Tick;
            while (_commands.Count > 0 && _commands.Peek().Key <= Now)
            {
                _command = _commands.Dequeue().Value;
            }
            _linear = Towards(_linear, _command.linear, LinearAcceleration * Tick);
            _angular = Towards(_angular, _command.angular, AngularAcceleration * Tick);
            double distance = IsBlocked ? 0 : _linear * Tick;
            double turn = _angular * Tick;
            Turned += turn;
            double middle = Truth.yaw + turn / 2;
            Truth = new PlanarPose(
                Truth.x + distance * Math.Cos(middle),
                Truth.y + distance * Math.Sin(middle),
                Planar.Wrap(Truth.yaw + turn));
            if (HasOdometry && Now >= _nextOdometry)
            {
                _nextOdometry = Now + OdometryPeriod;
                _poses.Enqueue(new KeyValuePair<double, PlanarPose>(Now + _delay, Noisy()));
            }
            while (_poses.Count > 0 && _poses.Peek().Key <= Now)
            {
                KeyValuePair<double, PlanarPose> arrived = _poses.Dequeue();
                _seen = arrived.Value;
                _seenTime = arrived.Key;
            }
        }

        private PlanarPose Noisy() => new PlanarPose(
            Truth.x + Noise(), Truth.y + Noise(), Planar.Wrap(Truth.yaw + Noise()));

        private double Noise() => _noise * (_random.NextDouble() + _random.NextDouble() - 1) * 2;

        private static double Towards(double value, double target, double most) =>
            value + Math.Max(-most, Math.Min(most, target - value));
    }
}
