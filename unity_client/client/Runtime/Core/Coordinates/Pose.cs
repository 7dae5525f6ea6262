// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway
{
    /// <summary>A position and a rotation, or a transform: first rotated, then moved.</summary>
    public readonly struct Pose<TFrame> : IEquatable<Pose<TFrame>>
        where TFrame : struct, IFrame
    {
        /// <summary>The place, in metres.</summary>
        public readonly Vector3<TFrame> position;

        /// <summary>The attitude.</summary>
        public readonly Quaternion<TFrame> orientation;

        /// <summary>Takes both as they are.</summary>
        public Pose(Vector3<TFrame> position, Quaternion<TFrame> orientation) =>
            (this.position, this.orientation) = (position, orientation);

        /// <summary>The transform back, of an orientation of length 1.</summary>
        public Pose<TFrame> Inverse
        {
            get
            {
                Quaternion<TFrame> back = orientation.Inverse;
                return new Pose<TFrame>(-1 * (back * position), back);
            }
        }

        /// <summary>The same pose as the other frame names it. Exact.</summary>
        public Pose<TOther> To<TOther>()
            where TOther : struct, IFrame =>
            new Pose<TOther>(position.To<TOther>(), orientation.To<TOther>());

        /// <summary>The pose <paramref name="child"/>, given relative to <paramref name="parent"/>.</summary>
        public static Pose<TFrame> operator *(Pose<TFrame> parent, Pose<TFrame> child) =>
            new Pose<TFrame>(parent * child.position, parent.orientation * child.orientation);

        /// <summary>The point, given relative to <paramref name="parent"/>.</summary>
        public static Vector3<TFrame> operator *(Pose<TFrame> parent, Vector3<TFrame> point) =>
            parent.position + parent.orientation * point;

        /// <summary>Equal to the last bit, except that NaN equals NaN.</summary>
        public bool Equals(Pose<TFrame> other) => position.Equals(other.position) && orientation.Equals(other.orientation);

        /// <inheritdoc/>
        public override bool Equals(object obj) => obj is Pose<TFrame> && Equals((Pose<TFrame>)obj);

        /// <inheritdoc/>
        public override int GetHashCode() => unchecked(position.GetHashCode() * 397 ^ orientation.GetHashCode());

        /// <summary>For people.</summary>
        public override string ToString() => position + " " + orientation;
    }
}
