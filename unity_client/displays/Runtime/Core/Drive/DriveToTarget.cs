// SPDX-License-Identifier: Apache-2.0
using System;
using System.Globalization;

namespace Ros2Gateway.Drive
{
    /// <summary>
    /// Drives a robot with two driven wheels to a point on the floor by its odometry, in steps. Turn towards
    /// it, drive, turn again where the heading has drifted, until it is reached. Pure: time and pose are
    /// arguments, the command is the result, always finite and within the limits. Not for several threads.
    /// </summary>
    /// <remarks>
    /// Step it at 10 to 50 Hz and send every command, the zeros too: a robot that hears nothing may drive on
    /// for half a second. It sees no obstacle. One that stops the robot ends in <see
    /// cref="DriveState.Failed"/>.
    /// </remarks>
    public sealed class DriveToTarget
    {
        private const double SteeringDistance = 0.10; // m: nearer, the direction to it is mostly noise
        private const double NearerMetres = 0.01; // less is the odometry's noise, not progress
        private const double NearerRadians = 0.05;

        private readonly DriveSettings _settings;
        private readonly Pid _turning;
        private readonly Pid _driving;
        private double _targetX;
        private double _targetY;
        private double _now;
        private double _poseTime;
        private double _sincePose;
        private double _waited;
        private double _sinceProgress;
        private double _elapsed;
        private double _allowed;
        private double _bestDistance;
        private double _bestTurn;
        private double _turn;

        /// <summary>Copies the settings: later changes to them change nothing here.</summary>
        /// <exception cref="ArgumentException">A setting makes no sense. The text names it.</exception>
        public DriveToTarget(DriveSettings settings)
        {
            _settings = settings.Checked();
            _turning = new Pid(_settings.turning, _settings.maxAngular);
            _driving = new Pid(_settings.driving, _settings.maxLinear);
            Reason = "";
        }

        /// <summary>Its activity since the last step, target or stop.</summary>
        public DriveState State { get; private set; }

        /// <summary>Why it failed, waits or was stopped, in words. Empty otherwise.</summary>
        public string Reason { get; private set; }

        /// <summary>Metres from the target at the last usable pose. NaN before there was one.</summary>
        public double Distance { get; private set; }

        /// <summary>Whether there is a target that is neither reached nor given up.</summary>
        public bool IsActive =>
            State == DriveState.Waiting || State == DriveState.Turning
                || State == DriveState.Driving;

        /// <summary>
        /// Drives to a point from the next step on, in the odometry's frame, in metres. The former target
        /// is dropped. A point that is not finite is a failure at once.
        /// </summary>
        public void SetTarget(double x, double y, double nowSeconds)
        {
            Distance = double.NaN;
            if (!Pid.IsFinite(x) || !Pid.IsFinite(y) || !Pid.IsFinite(nowSeconds))
            {
                End(DriveState.Failed, "the target is not finite");
                return;
            }
            _targetX = x;
            _targetY = y;
            _now = nowSeconds;
            _poseTime = double.NaN;
            _sincePose = 0;
            _waited = 0;
            _sinceProgress = 0;
            _elapsed = 0;
            _allowed = double.PositiveInfinity;
            _bestDistance = double.PositiveInfinity;
            End(DriveState.Waiting, "waiting for the first pose");
        }

        /// <summary>
        /// Takes the target away. The reason is for people. Without a target nothing happens.
        /// </summary>
        public void Stop(string reason)
        {
            if (IsActive)
            {
                End(DriveState.Idle, reason);
            }
        }

        /// <summary>
        /// The command for now, given the newest pose and when it came, both times in seconds of one clock. A
        /// clock that goes back stands still for that step. A pose that is not finite is ignored.
        /// </summary>
        public DriveCommand Step(PlanarPose pose, double poseTime, double now)
        {
            if (!IsActive || !Pid.IsFinite(now))
            {
                return DriveCommand.Zero;
            }
            // A pause of the whole application is not a time in which the robot could have done anything.
            double step = Math.Max(0, Math.Min(now - _now, _settings.staleSeconds));
            _now = now;
            _elapsed += step;
            if (!IsFresh(pose, poseTime, step))
            {
                return Wait(step);
            }
            _waited = 0;
            Distance = Math.Sqrt(Square(_targetX - pose.x) + Square(_targetY - pose.y));
            if (Distance <= _settings.tolerance)
            {
                return End(DriveState.Done, "");
            }
            if (double.IsInfinity(_allowed))
            {
                _allowed = _settings.timeoutSeconds + 3 * Distance / _settings.maxLinear;
            }
            if (_elapsed > _allowed)
            {
                return Fail("not there after {0:0.0} s, {1:0.00} m from the target", _elapsed);
            }
            double turn = Planar.Wrap(Math.Atan2(_targetY - pose.y, _targetX - pose.x) - pose.yaw);
            DriveCommand command = State == DriveState.Driving ? Drive(turn, now) : Turn(turn, now);
            _sinceProgress = IsNearer() ? 0 : _sinceProgress + step;
            if (_sinceProgress > _settings.stuckSeconds)
            {
                return Fail("no progress for {0:0.0} s, {1:0.00} m from the target", _sinceProgress);
            }
            return command;
        }

        private bool IsFresh(PlanarPose pose, double poseTime, double step)
        {
            // The time stamp alone is not enough: after a clock went back, old poses seem new.
            if (poseTime != _poseTime)
            {
                _poseTime = poseTime;
                _sincePose = 0;
            }
            else
            {
                _sincePose += step;
            }
            return pose.IsFinite && Pid.IsFinite(poseTime)
                && _sincePose < _settings.staleSeconds && _now - poseTime <= _settings.staleSeconds;
        }

        private DriveCommand Wait(double step)
        {
            _waited += step;
            if (State != DriveState.Waiting)
            {
                End(DriveState.Waiting, "waiting for a fresh pose");
            }
            return _waited > _settings.waitSeconds
                ? Fail("no fresh pose for {0:0.0} s", _waited)
                : DriveCommand.Zero;
        }

        private DriveCommand Turn(double turn, double now)
        {
            if (State != DriveState.Turning)
            {
                Begin(DriveState.Turning, turn);
            }
            // With the target behind, noise makes left of right: keep to the way begun.
            turn = _turn + Planar.Wrap(turn - _turn);
            if (Math.Abs(turn) > 1.5 * Math.PI)
            {
                turn = Planar.Wrap(turn);
                _turning.Reset();
            }
            _turn = turn;
            if (Math.Abs(turn) < _settings.aim)
            {
                Begin(DriveState.Driving, turn);
                return Drive(turn, now);
            }
            return new DriveCommand(0, _turning.Step(turn, now));
        }

        private DriveCommand Drive(double turn, double now)
        {
            double ahead = Distance * Math.Cos(turn);
            bool steers = Distance > SteeringDistance;
            // Near the target, what is left to its side takes another turn once it is abeam.
            bool passed = !steers && Math.Abs(ahead) < _settings.tolerance / 2;
            if (passed || (steers && Math.Abs(turn) > _settings.drift))
            {
                Begin(DriveState.Turning, turn);
                return Turn(turn, now);
            }
            double angular = steers ? _turning.Step(turn, now) : 0;
            return new DriveCommand(_driving.Step(ahead, now), angular);
        }

        private void Begin(DriveState state, double turn)
        {
            State = state;
            Reason = "";
            _turn = turn;
            _bestTurn = double.PositiveInfinity;
            _turning.Reset();
            _driving.Reset();
        }

        private DriveCommand End(DriveState state, string reason)
        {
            State = state;
            Reason = reason;
            return DriveCommand.Zero;
        }

        private DriveCommand Fail(string words, double seconds)
        {
            string reason = string.Format(CultureInfo.InvariantCulture, words, seconds, Distance);
            return End(DriveState.Failed, reason);
        }

        private bool IsNearer()
        {
            bool nearer = Distance < _bestDistance - NearerMetres;
            if (nearer)
            {
                _bestDistance = Distance;
            }
            if (State == DriveState.Turning && Math.Abs(_turn) < _bestTurn - NearerRadians)
            {
                _bestTurn = Math.Abs(_turn);
                nearer = true;
            }
            return nearer;
        }

        private static double Square(double value) => value * value;
    }
}
