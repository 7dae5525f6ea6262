// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway.Robots
{
    /// <summary>How a joint moves.</summary>
    public enum JointMotion
    {
        /// <summary>Not at all. Also floating and planar joints, whose several positions a state has not.</summary>
        None,

        /// <summary>About its axis, in radians.</summary>
        Turning,

        /// <summary>Along its axis, in metres.</summary>
        Sliding,
    }

    /// <summary>A joint of two links, and how one moves in the other's frame.</summary>
    public sealed class RobotJoint
    {
        private readonly Pose<Flu> _origin;
        private readonly Vector3<Flu> _axis;

        internal RobotJoint(
            string name, string parent, string child, JointMotion motion, Pose<Flu> origin, Vector3<Flu> axis,
            string mimicked, double multiplier, double offset)
        {
            Name = name;
            Parent = parent;
            Child = child;
            Motion = motion;
            _origin = origin;
            _axis = axis;
            Mimicked = mimicked;
            Multiplier = multiplier;
            Offset = offset;
        }

        /// <summary>Its name, as in JointState.</summary>
        public string Name { get; private set; }

        /// <summary>The link from which it hangs.</summary>
        public string Parent { get; private set; }

        /// <summary>The link that hangs from it.</summary>
        public string Child { get; private set; }

        /// <summary>How it moves.</summary>
        public JointMotion Motion { get; private set; }

        /// <summary>The joint whose position it follows. Empty for none.</summary>
        public string Mimicked { get; private set; }

        /// <summary>Its position is that of the mimicked joint, so many times ...</summary>
        public double Multiplier { get; private set; }

        /// <summary>... and this added.</summary>
        public double Offset { get; private set; }

        /// <summary>The pose of the child in its parent's frame. A position that is not finite counts as 0.</summary>
        public Pose<Flu> PoseAt(double position)
        {
            double by = double.IsNaN(position) || double.IsInfinity(position) ? 0 : position;
            if (Motion == JointMotion.Turning)
            {
                double s = Math.Sin(by / 2);
                return _origin * new Pose<Flu>(
                    default(Vector3<Flu>), new Quaternion<Flu>(s * _axis.x, s * _axis.y, s * _axis.z, Math.Cos(by / 2)));
            }
            if (Motion == JointMotion.Sliding)
            {
                return _origin * new Pose<Flu>(by * _axis, Quaternion<Flu>.Identity);
            }
            return _origin;
        }
    }
}
