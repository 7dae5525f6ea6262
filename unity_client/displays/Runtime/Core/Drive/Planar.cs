// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway
{
    /// <summary>Rotations of what drives on a floor: yaw in ROS, heading in Unity.</summary>
    public static class Planar
    {
        /// <summary>
        /// Radians, counter-clockwise from above, from -pi to pi: where the forward axis points on the floor.
        /// Right for quaternions of any length but 0 (then 0), and for a robot on a slope. Of one that looks
        /// straight up or down nobody knows it.
        /// </summary>
        public static double Yaw(this Quaternion<Flu> orientation)
        {
            Quaternion<Flu> unit = orientation.Normalized;
            Vector3<Flu> forward = unit * new Vector3<Flu>(1, 0, 0);
            return Math.Atan2(forward.y, forward.x);
        }

        /// <summary>
        /// Degrees, clockwise from above, from -180 to 180: what <c>eulerAngles.y</c> is in Unity, up to
        /// whole turns. Minus the <see cref="Yaw"/>.
        /// </summary>
        public static double HeadingDegrees(this Quaternion<Ruf> orientation)
        {
            Quaternion<Ruf> unit = orientation.Normalized;
            Vector3<Ruf> forward = unit * new Vector3<Ruf>(0, 0, 1);
            return Math.Atan2(forward.x, forward.z) * 180 / Math.PI;
        }

        /// <summary>An upright orientation with that yaw, in radians counter-clockwise from above.</summary>
        public static Quaternion<Flu> FromYaw(double yaw) => new Quaternion<Flu>(0, 0, Math.Sin(yaw / 2), Math.Cos(yaw / 2));

        /// <summary>An upright orientation with that heading, in degrees clockwise from above.</summary>
        public static Quaternion<Ruf> FromHeadingDegrees(double heading)
        {
            double half = heading * Math.PI / 360;
            return new Quaternion<Ruf>(0, Math.Sin(half), 0, Math.Cos(half));
        }

        /// <summary>
        /// The same direction within -pi to pi, both in radians. NaN for what is not finite.
        /// </summary>
        public static double Wrap(double angle) => Math.IEEERemainder(angle, 2 * Math.PI);
    }
}
