// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway
{
    /// <summary>The present ROS time by the gateway's clock, learnt from each ping.</summary>
    /// <remarks>
    /// Of the newest pings the one that came back fastest counts (as in NTP, RFC 5905, section 10): half
    /// of its round trip bounds the error.
    /// </remarks>
    public sealed class ClockOffset
    {
        private const int Samples = 16; // half a minute of heartbeats: a clock drifts by under 2 ms in that

        private const double DriftSeconds = 0.01; // clocks drift apart less than this in that time

        private readonly object _gate = new();
        private readonly Clock _clock;
        private readonly double[] _roundTrips = new double[Samples]; // ms
        private readonly double[] _offsets = new double[Samples]; // ROS time minus ours, s
        private int _count;
        private double _best; // s
        private double _bestRoundTrip; // ms

        internal ClockOffset(Clock clock) => _clock = clock;

        /// <summary>Whether anything is known yet.</summary>
        public bool IsKnown => !double.IsNaN(RosSeconds);

        /// <summary>How long the newest ping took, there and back, in milliseconds.</summary>
        public double RoundTripMilliseconds { get; private set; }

        /// <summary>How far <see cref="RosSeconds"/> may be wrong, in seconds.</summary>
        public double ErrorSeconds
        {
            get
            {
                lock (_gate)
                {
                    return _count == 0 ? double.PositiveInfinity : _bestRoundTrip / 2000;
                }
            }
        }

        /// <summary>ROS time now, in seconds since the epoch of its clock. NaN while nothing is known.</summary>
        public double RosSeconds
        {
            get
            {
                lock (_gate)
                {
                    return _count == 0 ? double.NaN : _clock.Precise / 1000 + _best;
                }
            }
        }

        /// <summary>A ping has come back.</summary>
        /// <param name="sent">When it left, in milliseconds of our clock.</param>
        /// <param name="rosSeconds">The time of the gateway's ROS clock in between.</param>
        internal void Add(double sent, double rosSeconds)
        {
            double now = _clock.Precise;
            double roundTrip = Math.Max(0, now - sent);
            double offset = rosSeconds - (sent + roundTrip / 2) / 1000;
            lock (_gate)
            {
                // Two samples differ by half of both round trips at most, unless a clock was set.
                if (Math.Abs(offset - _best) > (roundTrip + _bestRoundTrip) / 2000 + DriftSeconds)
                {
                    _count = 0;
                }
                int at = _count % Samples;
                _roundTrips[at] = roundTrip;
                _offsets[at] = offset;
                _count++;
                RoundTripMilliseconds = roundTrip;
                int best = 0;
                for (int i = 1; i < Math.Min(_count, Samples); i++)
                {
                    best = _roundTrips[i] < _roundTrips[best] ? i : best;
                }
                _best = _offsets[best];
                _bestRoundTrip = _roundTrips[best];
            }
        }

        /// <summary>Another connection may be another gateway with another clock.</summary>
        internal void Forget()
        {
            lock (_gate)
            {
                _count = 0;
            }
        }
    }
}
