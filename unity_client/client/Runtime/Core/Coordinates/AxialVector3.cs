// SPDX-License-Identifier: Apache-2.0
using System;
using System.Globalization;

namespace Ros2Gateway
{
    /// <summary>
    /// An angular velocity (rad/s) or a torque in a frame: its sense of rotation follows the frame's hand, so
    /// between ROS and Unity it changes sign against a <see cref="Vector3{TFrame}"/>.
    /// </summary>
    public readonly struct AxialVector3<TFrame> : IEquatable<AxialVector3<TFrame>>
        where TFrame : struct, IFrame
    {
        /// <summary>About the frame's first axis.</summary>
        public readonly double x;

        /// <summary>About the frame's second axis.</summary>
        public readonly double y;

        /// <summary>About the frame's third axis.</summary>
        public readonly double z;

        /// <summary>Takes components that are in the frame already.</summary>
        public AxialVector3(double x, double y, double z) => (this.x, this.y, this.z) = (x, y, z);

        /// <summary>The same rotation as the other frame names it. Exact.</summary>
        public AxialVector3<TOther> To<TOther>()
            where TOther : struct, IFrame
        {
            double a = x, b = y, c = z;
            FrameChange.Axial<TFrame, TOther>(ref a, ref b, ref c);
            return new AxialVector3<TOther>(a, b, c);
        }

        /// <summary>The cross product: the velocity, by this rotation, of what is at that position.</summary>
        public Vector3<TFrame> Cross(Vector3<TFrame> position) => new Vector3<TFrame>(
            y * position.z - z * position.y,
            z * position.x - x * position.z,
            x * position.y - y * position.x);

        /// <summary>Equal to the last bit, except that NaN equals NaN.</summary>
        public bool Equals(AxialVector3<TFrame> other) => x.Equals(other.x) && y.Equals(other.y) && z.Equals(other.z);

        /// <inheritdoc/>
        public override bool Equals(object obj) => obj is AxialVector3<TFrame> && Equals((AxialVector3<TFrame>)obj);

        /// <inheritdoc/>
        public override int GetHashCode() => unchecked((x.GetHashCode() * 397 ^ y.GetHashCode()) * 397 ^ z.GetHashCode());

        /// <summary>For people: frame and components.</summary>
        public override string ToString() => string.Format(
            CultureInfo.InvariantCulture, "{0}[{1:G6}, {2:G6}, {3:G6}]", typeof(TFrame).Name, x, y, z);
    }
}
