// SPDX-License-Identifier: Apache-2.0
using System;
using System.Globalization;

namespace Ros2Gateway.Drive
{
    /// <summary>The command for a base with two driven wheels, in its own axes.</summary>
    public readonly struct DriveCommand : IEquatable<DriveCommand>
    {
        /// <summary>Metres per second ahead: the <c>linear.x</c> of a Twist.</summary>
        public readonly double linear;

        /// <summary>Radians per second, counter-clockwise: the <c>angular.z</c> of a Twist.</summary>
        public readonly double angular;

        /// <summary>Takes speeds as they are.</summary>
        public DriveCommand(double linear, double angular)
        {
            this.linear = linear;
            this.angular = angular;
        }

        /// <summary>Stand still. The same as <c>default</c>.</summary>
        public static DriveCommand Zero => default;

        /// <inheritdoc/>
        public bool Equals(DriveCommand other) => linear.Equals(other.linear) && angular.Equals(other.angular);

        /// <inheritdoc/>
        public override bool Equals(object obj) => obj is DriveCommand && Equals((DriveCommand)obj);

        /// <inheritdoc/>
        public override int GetHashCode() => unchecked(linear.GetHashCode() * 397 ^ angular.GetHashCode());

        /// <summary>For people: both speeds with their units.</summary>
        public override string ToString() => string.Format(
            CultureInfo.InvariantCulture, "{0:0.###} m/s, {1:0.###} rad/s", linear, angular);
    }
}
