// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway.Drive
{
    /// <summary>
    /// The limits of a <see cref="DriveToTarget"/>, and when it gives up. Shows in Unity's Inspector. The
    /// defaults suit a TurtleBot3.
    /// </summary>
    [Serializable]
    public sealed class DriveSettings
    {
        /// <summary>m/s at most. The default is a TurtleBot3 Waffle Pi's.</summary>
        public double maxLinear = 0.26;

        /// <summary>rad/s at most. The default is a TurtleBot3 Waffle Pi's.</summary>
        public double maxAngular = 1.82;

        /// <summary>
        /// Metres from the target at which it counts as reached: 2 cm leave 3 for the odometry's faults.
        /// </summary>
        public double tolerance = 0.02;

        /// <summary>
        /// Radians: once the target is this straight ahead, turning ends and driving begins.
        /// </summary>
        public double aim = 0.05;

        /// <summary>
        /// Radians: once the target is this far off ahead, driving ends and turning begins again.
        /// </summary>
        public double drift = 0.4;

        /// <summary>Seconds without a new pose after which the robot is told to stand.</summary>
        public double staleSeconds = 0.5;

        /// <summary>Seconds of waiting for a pose after which the target is given up.</summary>
        public double waitSeconds = 5;

        /// <summary>Seconds of commands without coming nearer after which the target is given up.</summary>
        public double stuckSeconds = 5;

        /// <summary>
        /// Seconds after which the target is given up, beyond three times what the straight way takes.
        /// </summary>
        public double timeoutSeconds = 30;

        /// <summary>Of the error in heading, radians to rad/s.</summary>
        public PidGains turning = new(2.0, 0.1, 0.1);

        /// <summary>
        /// Of the distance, metres to m/s. The integral overcomes motors that do not start below some speed.
        /// </summary>
        public PidGains driving = new(1.2, 0.1, 0.05);

        internal DriveSettings Checked()
        {
            Require(maxLinear, "maxLinear");
            Require(maxAngular, "maxAngular");
            Require(tolerance, "tolerance");
            Require(aim, "aim");
            Require(drift, "drift");
            Require(staleSeconds, "staleSeconds");
            Require(waitSeconds, "waitSeconds");
            Require(stuckSeconds, "stuckSeconds");
            Require(timeoutSeconds, "timeoutSeconds");
            // Beyond 1 rad, a near target could be abeam and straight ahead at once.
            if (drift <= aim || drift > 1)
            {
                throw new ArgumentException("drift is above aim and at most 1 rad");
            }
            return (DriveSettings)MemberwiseClone();
        }

        private static void Require(double value, string name)
        {
            // written so that NaN fails it
            if (!(value > 0) || double.IsInfinity(value))
            {
                throw new ArgumentException(name + " is finite and above 0");
            }
        }
    }
}
