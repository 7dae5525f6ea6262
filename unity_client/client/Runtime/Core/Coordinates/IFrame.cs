// SPDX-License-Identifier: Apache-2.0
namespace Ros2Gateway
{
    /// <summary>
    /// Which way the axes point, as a type: what is in one frame cannot be taken for another. A frame
    /// relabels axes. It neither scales nor moves the origin. Implemented by empty structs, yours as well: an
    /// axis of a frame is an axis of <see cref="Flu"/>, or its opposite.
    /// </summary>
    public interface IFrame
    {
        /// <summary>Whether x cross y is minus z, as in Unity.</summary>
        bool IsLeftHanded { get; }

        /// <summary>
        /// Turns this frame's components of a polar vector into those of <see cref="Flu"/>.
        /// </summary>
        void ToFlu(ref double x, ref double y, ref double z);

        /// <summary>Turns components of <see cref="Flu"/> into this frame's.</summary>
        void FromFlu(ref double x, ref double y, ref double z);
    }

    /// <summary>
    /// ROS: x forward, y left, z up, right-handed (REP 103). Robots, and odom and map as well: at yaw 0 a
    /// robot looks along their x.
    /// </summary>
    public struct Flu : IFrame
    {
        /// <inheritdoc/>
        public bool IsLeftHanded => false;

        /// <inheritdoc/>
        public void ToFlu(ref double x, ref double y, ref double z)
        {
        }

        /// <inheritdoc/>
        public void FromFlu(ref double x, ref double y, ref double z)
        {
        }
    }

    /// <summary>
    /// Aircraft: the world's x north, y east, z down, right-handed, and on the body x forward, y right, z down.
    /// Unity's z is north. An attitude is that of the body's three in the world's three, as PX4 tells it.
    /// </summary>
    public struct Ned : IFrame
    {
        /// <inheritdoc/>
        public bool IsLeftHanded => false;

        /// <inheritdoc/>
        public void ToFlu(ref double x, ref double y, ref double z)
        {
            y = -y;
            z = -z;
        }

        /// <inheritdoc/>
        public void FromFlu(ref double x, ref double y, ref double z)
        {
            y = -y;
            z = -z;
        }
    }

    /// <summary>Unity: x right, y up, z forward, left-handed.</summary>
    public struct Ruf : IFrame
    {
        /// <inheritdoc/>
        public bool IsLeftHanded => true;

        /// <inheritdoc/>
        public void ToFlu(ref double x, ref double y, ref double z)
        {
            double right = x, up = y, forward = z;
            x = forward;
            y = -right;
            z = up;
        }

        /// <inheritdoc/>
        public void FromFlu(ref double x, ref double y, ref double z)
        {
            double forward = x, left = y, up = z;
            x = -left;
            y = up;
            z = forward;
        }
    }

    internal static class FrameChange
    {
        internal static void Polar<TFrom, TTo>(ref double x, ref double y, ref double z)
            where TFrom : struct, IFrame
            where TTo : struct, IFrame
        {
            default(TFrom).ToFlu(ref x, ref y, ref z);
            default(TTo).FromFlu(ref x, ref y, ref z);
        }

        internal static void Axial<TFrom, TTo>(ref double x, ref double y, ref double z)
            where TFrom : struct, IFrame
            where TTo : struct, IFrame
        {
            Polar<TFrom, TTo>(ref x, ref y, ref z);
            if (default(TFrom).IsLeftHanded != default(TTo).IsLeftHanded)
            {
                x = -x;
                y = -y;
                z = -z;
            }
        }
    }
}
