// SPDX-License-Identifier: Apache-2.0
using System;
using System.Globalization;

namespace Ros2Gateway
{
    /// <summary>
    /// A rotation or an orientation in a frame, of length 1 unless it came otherwise. Hamilton's product, as
    /// in ROS and in Unity. <c>default</c> is not a rotation at all but four zeros, see <see
    /// cref="Normalized"/>.
    /// </summary>
    public readonly struct Quaternion<TFrame> : IEquatable<Quaternion<TFrame>>
        where TFrame : struct, IFrame
    {
        /// <summary>First imaginary part.</summary>
        public readonly double x;

        /// <summary>Second imaginary part.</summary>
        public readonly double y;

        /// <summary>Third imaginary part.</summary>
        public readonly double z;

        /// <summary>Real part.</summary>
        public readonly double w;

        /// <summary>Takes components that are in the frame already, of any length.</summary>
        public Quaternion(double x, double y, double z, double w) =>
            (this.x, this.y, this.z, this.w) = (x, y, z, w);

        /// <summary>No rotation.</summary>
        public static Quaternion<TFrame> Identity => new Quaternion<TFrame>(0, 0, 0, 1);

        /// <summary>The opposite rotation, of a quaternion of length 1.</summary>
        public Quaternion<TFrame> Inverse => new Quaternion<TFrame>(-x, -y, -z, w);

        /// <summary>
        /// The same rotation at length 1. <see cref="Identity"/> for one of length 0, as careless publishers
        /// send it, and for what is not finite.
        /// </summary>
        public Quaternion<TFrame> Normalized
        {
            get
            {
                double length = Math.Sqrt(x * x + y * y + z * z + w * w);
                // written so that NaN fails it
                if (!(length > 0) || double.IsInfinity(length))
                {
                    return Identity;
                }
                return new Quaternion<TFrame>(x / length, y / length, z / length, w / length);
            }
        }

        /// <summary>The same orientation as the other frame names it. Exact.</summary>
        public Quaternion<TOther> To<TOther>()
            where TOther : struct, IFrame
        {
            double a = x, b = y, c = z;
            FrameChange.Axial<TFrame, TOther>(ref a, ref b, ref c);
            return new Quaternion<TOther>(a, b, c, w);
        }

        /// <summary>The rotation <paramref name="right"/>, followed by <paramref name="left"/>.</summary>
        public static Quaternion<TFrame> operator *(Quaternion<TFrame> left, Quaternion<TFrame> right) =>
            new Quaternion<TFrame>(
                left.w * right.x + left.x * right.w + left.y * right.z - left.z * right.y,
                left.w * right.y - left.x * right.z + left.y * right.w + left.z * right.x,
                left.w * right.z + left.x * right.y - left.y * right.x + left.z * right.w,
                left.w * right.w - left.x * right.x - left.y * right.y - left.z * right.z);

        /// <summary>The vector, rotated by a quaternion of length 1.</summary>
        public static Vector3<TFrame> operator *(Quaternion<TFrame> rotation, Vector3<TFrame> vector)
        {
            var axis = new AxialVector3<TFrame>(rotation.x, rotation.y, rotation.z);
            Vector3<TFrame> once = 2 * axis.Cross(vector);
            return vector + rotation.w * once + axis.Cross(once);
        }

        /// <summary>Equal to the last bit, except that NaN equals NaN. Q and -q differ.</summary>
        public bool Equals(Quaternion<TFrame> other) =>
            x.Equals(other.x) && y.Equals(other.y) && z.Equals(other.z) && w.Equals(other.w);

        /// <inheritdoc/>
        public override bool Equals(object obj) => obj is Quaternion<TFrame> && Equals((Quaternion<TFrame>)obj);

        /// <inheritdoc/>
        public override int GetHashCode()
        {
            int imaginary = unchecked((x.GetHashCode() * 397 ^ y.GetHashCode()) * 397 ^ z.GetHashCode());
            return unchecked(imaginary * 397 ^ w.GetHashCode());
        }

        /// <summary>For people: frame and components.</summary>
        public override string ToString() => string.Format(
            CultureInfo.InvariantCulture,
            "{0}({1:G6}, {2:G6}, {3:G6}; {4:G6})", typeof(TFrame).Name, x, y, z, w);
    }
}
