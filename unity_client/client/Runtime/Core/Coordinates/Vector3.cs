// SPDX-License-Identifier: Apache-2.0
using System;
using System.Globalization;

namespace Ros2Gateway
{
    /// <summary>
    /// A position, velocity, acceleration or force in a frame: a mirror mirrors it. A rotation is an
    /// <see cref="AxialVector3{TFrame}"/>.
    /// </summary>
    public readonly struct Vector3<TFrame> : IEquatable<Vector3<TFrame>>
        where TFrame : struct, IFrame
    {
        /// <summary>Along the frame's first axis.</summary>
        public readonly double x;

        /// <summary>Along the frame's second axis.</summary>
        public readonly double y;

        /// <summary>Along the frame's third axis.</summary>
        public readonly double z;

        /// <summary>Takes components that are in the frame already.</summary>
        public Vector3(double x, double y, double z) => (this.x, this.y, this.z) = (x, y, z);

        /// <summary>The Euclidean length.</summary>
        public double Length => Math.Sqrt(x * x + y * y + z * z);

        /// <summary>The same vector as the other frame names it. Exact.</summary>
        public Vector3<TOther> To<TOther>()
            where TOther : struct, IFrame
        {
            double a = x, b = y, c = z;
            FrameChange.Polar<TFrame, TOther>(ref a, ref b, ref c);
            return new Vector3<TOther>(a, b, c);
        }

        /// <summary>The sum, component by component.</summary>
        public static Vector3<TFrame> operator +(Vector3<TFrame> left, Vector3<TFrame> right) =>
            new Vector3<TFrame>(left.x + right.x, left.y + right.y, left.z + right.z);

        /// <summary>The difference, component by component.</summary>
        public static Vector3<TFrame> operator -(Vector3<TFrame> left, Vector3<TFrame> right) =>
            new Vector3<TFrame>(left.x - right.x, left.y - right.y, left.z - right.z);

        /// <summary>The same direction, <paramref name="factor"/> times as long.</summary>
        public static Vector3<TFrame> operator *(double factor, Vector3<TFrame> vector) =>
            new Vector3<TFrame>(factor * vector.x, factor * vector.y, factor * vector.z);

        /// <summary>Equal to the last bit, except that NaN equals NaN.</summary>
        public bool Equals(Vector3<TFrame> other) => x.Equals(other.x) && y.Equals(other.y) && z.Equals(other.z);

        /// <inheritdoc/>
        public override bool Equals(object obj) => obj is Vector3<TFrame> && Equals((Vector3<TFrame>)obj);

        /// <inheritdoc/>
        public override int GetHashCode() => unchecked((x.GetHashCode() * 397 ^ y.GetHashCode()) * 397 ^ z.GetHashCode());

        /// <summary>For people: frame and components.</summary>
        public override string ToString() => string.Format(
            CultureInfo.InvariantCulture, "{0}({1:G6}, {2:G6}, {3:G6})", typeof(TFrame).Name, x, y, z);
    }
}
