// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway.Drive
{
    /// <summary>
    /// A controller of one quantity. Time is an argument. Its output is always finite and within its limit.
    /// Not for several threads.
    /// </summary>
    /// <remarks>
    /// The derivative is the error's, not the measurement's, so that errors of angles need nobody to unwrap
    /// two signals: with the setpoint at rest they are the same except the sign. A caller that moves the setpoint
    /// by a jump calls <see cref="Reset"/>, and no kick follows. Against windup the integral stands still
    /// while the output is at its limit and the error pushes further, and alone never exceeds it.
    /// </remarks>
    public sealed class Pid
    {
        private const double MaxStep = 0.5; // s: after a longer silence what was remembered means nothing
        private const double DerivativeFilter = 0.05; // s, three samples of odometry: its noise is not motion

        private readonly PidGains _gains;
        private readonly double _limit;
        private double _integral;
        private double _slope;
        private double _error;
        private double _time;
        private bool _started;

        /// <summary>
        /// Makes a controller whose output stays within plus and minus <paramref name="limit"/>.
        /// </summary>
        /// <exception cref="ArgumentException">A gain or the limit is negative or not finite.</exception>
        public Pid(PidGains gains, double limit)
        {
            if (!IsGain(gains.proportional) || !IsGain(gains.integral) || !IsGain(gains.derivative))
            {
                throw new ArgumentException("a PID's gains are finite and not below 0", "gains");
            }
            if (!(limit > 0) || double.IsInfinity(limit))
            {
                throw new ArgumentException("a PID's output limit is finite and above 0", "limit");
            }
            _gains = gains;
            _limit = limit;
        }

        /// <summary>Forgets the past: for a new setpoint, or after the output was not obeyed.</summary>
        public void Reset()
        {
            _integral = 0;
            _slope = 0;
            _started = false;
        }

        /// <summary>
        /// The output for the error (setpoint minus measurement) at a time in seconds of any clock. If
        /// that has stood still nothing is learned from the step. If it went back, or on by more than half
        /// a second, the past is forgotten. 0 for an error or a time that is not finite.
        /// </summary>
        public double Step(double error, double now)
        {
            if (!IsFinite(error) || !IsFinite(now))
            {
                Reset();
                return 0;
            }
            double step = now - _time;
            if (_started && (step < 0 || step > MaxStep))
            {
                Reset();
            }
            double increment = 0;
            if (_started && step > 0)
            {
                double share = step / (DerivativeFilter + step);
                _slope += share * ((error - _error) / step - _slope);
                _slope = IsFinite(_slope) ? _slope : 0; // infinite once would be NaN forever
                increment = _gains.integral * error * step;
            }
            _started = true;
            _error = error;
            _time = now;

            double rest = _gains.proportional * error + _gains.derivative * _slope;
            double wanted = rest + _integral + increment;
            if (Math.Abs(wanted) <= _limit || increment * wanted < 0)
            {
                _integral = Within(_integral + increment, _limit);
            }
            double output = rest + _integral;
            // Finite errors of 1e308 can still make a NaN of infinities.
            return double.IsNaN(output) ? 0 : Within(output, _limit);
        }

        internal static double Within(double value, double limit) => Math.Max(-limit, Math.Min(limit, value));

        internal static bool IsFinite(double value) => !double.IsNaN(value) && !double.IsInfinity(value);

        private static bool IsGain(double value) => value >= 0 && !double.IsInfinity(value);
    }
}
