// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Messages.GeometryMsgs;

namespace Ros2Gateway
{
    /// <summary>
    /// From <c>geometry_msgs</c> to vectors that know their frame, and back. The message does not say which
    /// way its axes point, so the caller does: <c>msg.pose.position.As&lt;Flu&gt;().To&lt;Ruf&gt;()</c>. Sent
    /// messages are in ROS' own axes, so the way back takes <see cref="Flu"/> only. Only the methods that return a
    /// message allocate.
    /// </summary>
    public static class MessageCoordinates
    {
        /// <summary>The point, whose axes are those of <typeparamref name="TFrame"/>.</summary>
        public static Vector3<TFrame> As<TFrame>(this PointMsg message)
            where TFrame : struct, IFrame =>
            new Vector3<TFrame>(message.x, message.y, message.z);

        /// <summary>
        /// A polar vector: <c>linear</c>, <c>force</c>, <c>translation</c>, <c>linear_acceleration</c>.
        /// </summary>
        public static Vector3<TFrame> As<TFrame>(this Vector3Msg message)
            where TFrame : struct, IFrame =>
            new Vector3<TFrame>(message.x, message.y, message.z);

        /// <summary>An axial vector: <c>angular</c>, <c>torque</c>, <c>angular_velocity</c>.</summary>
        public static AxialVector3<TFrame> AsAxial<TFrame>(this Vector3Msg message)
            where TFrame : struct, IFrame =>
            new AxialVector3<TFrame>(message.x, message.y, message.z);

        /// <summary>The quaternion as it came, of any length.</summary>
        public static Quaternion<TFrame> As<TFrame>(this QuaternionMsg message)
            where TFrame : struct, IFrame =>
            new Quaternion<TFrame>(message.x, message.y, message.z, message.w);

        /// <summary>Position and orientation as they came.</summary>
        public static Pose<TFrame> As<TFrame>(this PoseMsg message)
            where TFrame : struct, IFrame =>
            new Pose<TFrame>(message.position.As<TFrame>(), message.orientation.As<TFrame>());

        /// <summary>Translation and rotation as they came.</summary>
        public static Pose<TFrame> As<TFrame>(this TransformMsg message)
            where TFrame : struct, IFrame =>
            new Pose<TFrame>(message.translation.As<TFrame>(), message.rotation.As<TFrame>());

        /// <summary>Writes the point into a message that is there already.</summary>
        public static void CopyTo(this Vector3<Flu> vector, PointMsg message) =>
            (message.x, message.y, message.z) = (vector.x, vector.y, vector.z);

        /// <summary>Writes the vector into a message that is there already.</summary>
        public static void CopyTo(this Vector3<Flu> vector, Vector3Msg message) =>
            (message.x, message.y, message.z) = (vector.x, vector.y, vector.z);

        /// <summary>Writes the vector into a message that is there already.</summary>
        public static void CopyTo(this AxialVector3<Flu> vector, Vector3Msg message) =>
            (message.x, message.y, message.z) = (vector.x, vector.y, vector.z);

        /// <summary>Writes the quaternion into a message that is there already.</summary>
        public static void CopyTo(this Quaternion<Flu> quaternion, QuaternionMsg message) =>
            (message.x, message.y, message.z, message.w) = (quaternion.x, quaternion.y, quaternion.z, quaternion.w);

        /// <summary>Writes the pose into a message that is there already.</summary>
        public static void CopyTo(this Pose<Flu> pose, PoseMsg message)
        {
            pose.position.CopyTo(message.position);
            pose.orientation.CopyTo(message.orientation);
        }

        /// <summary>Writes the pose into a message that is there already.</summary>
        public static void CopyTo(this Pose<Flu> pose, TransformMsg message)
        {
            pose.position.CopyTo(message.translation);
            pose.orientation.CopyTo(message.rotation);
        }

        /// <summary>A new message.</summary>
        public static PointMsg ToPointMsg(this Vector3<Flu> vector)
        {
            var message = new PointMsg();
            vector.CopyTo(message);
            return message;
        }

        /// <summary>A new message.</summary>
        public static PoseMsg ToPoseMsg(this Pose<Flu> pose)
        {
            var message = new PoseMsg();
            pose.CopyTo(message);
            return message;
        }

        /// <summary>A new message.</summary>
        public static TransformMsg ToTransformMsg(this Pose<Flu> pose)
        {
            var message = new TransformMsg();
            pose.CopyTo(message);
            return message;
        }

        /// <summary>A new message of a body's speeds, in its own axes: m/s and rad/s.</summary>
        public static TwistMsg ToTwistMsg(Vector3<Flu> linear, AxialVector3<Flu> angular)
        {
            var message = new TwistMsg();
            linear.CopyTo(message.linear);
            angular.CopyTo(message.angular);
            return message;
        }
    }
}
