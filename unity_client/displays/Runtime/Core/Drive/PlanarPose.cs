// SPDX-License-Identifier: Apache-2.0
namespace Ros2Gateway
{
    /// <summary>A place on the floor and where something there looks, in ROS' axes.</summary>
    public readonly struct PlanarPose
    {
        /// <summary>Metres along x.</summary>
        public readonly double x;

        /// <summary>Metres along y.</summary>
        public readonly double y;

        /// <summary>Radians, counter-clockwise from x.</summary>
        public readonly double yaw;

        /// <summary>Takes metres and radians as they are.</summary>
        public PlanarPose(double x, double y, double yaw)
        {
            this.x = x;
            this.y = y;
            this.yaw = yaw;
        }

        /// <summary>A pose on the floor, without height, roll and pitch.</summary>
        public PlanarPose(Pose<Flu> pose)
            : this(pose.position.x, pose.position.y, pose.orientation.Yaw())
        {
        }

        /// <summary>Whether no component is NaN or infinite.</summary>
        public bool IsFinite
        {
            // A difference to itself is 0 for every finite number and NaN for the others.
            get { return x - x == 0 && y - y == 0 && yaw - yaw == 0; }
        }

        /// <summary>The upright pose at height 0.</summary>
        public Pose<Flu> ToPose() => new Pose<Flu>(new Vector3<Flu>(x, y, 0), Planar.FromYaw(yaw));
    }
}
