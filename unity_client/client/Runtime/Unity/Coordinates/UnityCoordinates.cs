// SPDX-License-Identifier: Apache-2.0
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// Between vectors that know their frame and UnityEngine's, which are right, up, forward. ROS to Unity is
    /// <c>msg.pose.As&lt;Flu&gt;().ToUnity()</c>. Unity to ROS is
    /// <c>transform.position.FromUnity&lt;Flu&gt;()</c>. UnityEngine counts in floats: beyond 10 km from the
    /// origin a millimetre is lost.
    /// </summary>
    public static class UnityCoordinates
    {
        /// <summary>A position or another polar vector, for UnityEngine.</summary>
        public static Vector3 ToUnity<TFrame>(this Vector3<TFrame> vector)
            where TFrame : struct, IFrame
        {
            Vector3<Ruf> unity = vector.To<Ruf>();
            return new Vector3((float)unity.x, (float)unity.y, (float)unity.z);
        }

        /// <summary>
        /// An angular velocity in rad/s, for UnityEngine: what <c>Rigidbody.angularVelocity</c> takes.
        /// </summary>
        public static Vector3 ToUnity<TFrame>(this AxialVector3<TFrame> vector)
            where TFrame : struct, IFrame
        {
            AxialVector3<Ruf> unity = vector.To<Ruf>();
            return new Vector3((float)unity.x, (float)unity.y, (float)unity.z);
        }

        /// <summary>
        /// An orientation of length 1, for UnityEngine. Identity where the length is 0 or NaN.
        /// </summary>
        public static Quaternion ToUnity<TFrame>(this Quaternion<TFrame> quaternion)
            where TFrame : struct, IFrame
        {
            Quaternion<Ruf> unity = quaternion.To<Ruf>().Normalized;
            return new Quaternion((float)unity.x, (float)unity.y, (float)unity.z, (float)unity.w);
        }

        /// <summary>Position and orientation, for UnityEngine.</summary>
        public static Pose ToUnity<TFrame>(this Pose<TFrame> pose)
            where TFrame : struct, IFrame =>
            new Pose(pose.position.ToUnity(), pose.orientation.ToUnity());

        /// <summary>A position or another polar vector of UnityEngine, in the frame asked for.</summary>
        public static Vector3<TFrame> FromUnity<TFrame>(this Vector3 vector)
            where TFrame : struct, IFrame =>
            new Vector3<Ruf>(vector.x, vector.y, vector.z).To<TFrame>();

        /// <summary>An angular velocity or a torque of UnityEngine, in the frame asked for.</summary>
        public static AxialVector3<TFrame> FromUnityAxial<TFrame>(this Vector3 vector)
            where TFrame : struct, IFrame =>
            new AxialVector3<Ruf>(vector.x, vector.y, vector.z).To<TFrame>();

        /// <summary>An orientation of UnityEngine, in the frame asked for.</summary>
        public static Quaternion<TFrame> FromUnity<TFrame>(this Quaternion quaternion)
            where TFrame : struct, IFrame =>
            new Quaternion<Ruf>(quaternion.x, quaternion.y, quaternion.z, quaternion.w).To<TFrame>();

        /// <summary>Position and orientation of UnityEngine, in the frame asked for.</summary>
        public static Pose<TFrame> FromUnity<TFrame>(this Pose pose)
            where TFrame : struct, IFrame =>
            new Pose<TFrame>(pose.position.FromUnity<TFrame>(), pose.rotation.FromUnity<TFrame>());

        /// <summary>The pose of a Transform in the world, in the frame asked for.</summary>
        public static Pose<TFrame> ToPose<TFrame>(this Transform transform)
            where TFrame : struct, IFrame =>
            new Pose<TFrame>(
                transform.position.FromUnity<TFrame>(), transform.rotation.FromUnity<TFrame>());
    }
}
