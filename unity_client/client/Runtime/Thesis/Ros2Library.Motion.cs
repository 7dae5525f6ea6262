// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Messages.NavMsgs;

namespace Ros2Gateway.Thesis
{
    /// <content>Velocities, poses and odometry, in ROS coordinates: metres and radians.</content>
    public static partial class Ros2Library
    {
        private const int CovarianceLength = 36; // 6 by 6, row by row

        /// <summary>Sends a velocity: x, y, z linear in metres, rx, ry, rz angular in radians per second.</summary>
        public static bool send_twist(string topic, double x, double y, double z, double rx, double ry, double rz)
        {
            TwistMsg twist = new();
            twist.linear.x = x;
            twist.linear.y = y;
            twist.linear.z = z;
            twist.angular.x = rx;
            twist.angular.y = ry;
            twist.angular.z = rz;
            return send(topic, twist);
        }

        /// <summary>Sends a pose in a frame.</summary>
        public static bool send_pose(
            string topic, uint sec, uint nanosec, string frame_id, double x, double y, double z,
            double quat_x, double quat_y, double quat_z, double quat_w)
        {
            PoseStampedMsg message = new();
            Put(message.pose, x, y, z, quat_x, quat_y, quat_z, quat_w);
            return Stamp("send_pose", topic, message.header, sec, nanosec, frame_id) && send(topic, message);
        }

        /// <summary>Sends a pose with its covariance.</summary>
        /// <param name="covariance">36 values, row by row.</param>
        public static bool send_pose_with_cov(
            string topic, uint sec, uint nanosec, string frame_id, double x, double y, double z,
            double quat_x, double quat_y, double quat_z, double quat_w, double[] covariance)
        {
            PoseWithCovarianceStampedMsg message = new();
            Put(message.pose.pose, x, y, z, quat_x, quat_y, quat_z, quat_w);
            message.pose.covariance = covariance;
            lock (Gate)
            {
                return HasCovariance("send_pose_with_cov", topic, "covariance", covariance)
                    && Stamp("send_pose_with_cov", topic, message.header, sec, nanosec, frame_id)
                    && send(topic, message);
            }
        }

        /// <summary>Takes the oldest unread velocity: x, y, z linear, rx, ry, rz angular.</summary>
        public static bool poll_twist(
            string topic, ref double x, ref double y, ref double z, ref double rx, ref double ry, ref double rz)
        {
            if (!Poll("poll_twist", topic, out TwistMsg twist))
            {
                return false;
            }
            Put(twist, ref x, ref y, ref z, ref rx, ref ry, ref rz);
            return true;
        }

        /// <summary>Takes the oldest unread odometry.</summary>
        /// <param name="frame_id_size">How many bytes fit. Becomes how many were written, as all sizes.</param>
        /// <param name="no_covariance">Whether the covariances are left alone. Their arrays may be null then.</param>
        /// <returns>False without a message, or if an array is too small: then it stays, and a debug message says why.</returns>
        public static bool poll_odometry<TFrame, TChild>(
            string topic, ref uint sec, ref uint nanosec, TextBuffer frame_id, ref TFrame frame_id_size,
            TextBuffer child_frame_id, ref TChild child_frame_id_size, bool no_covariance,
            ref double x, ref double y, ref double z,
            ref double quat_x, ref double quat_y, ref double quat_z, ref double quat_w, double[] covariance,
            ref double vel_x, ref double vel_y, ref double vel_z,
            ref double rot_x, ref double rot_y, ref double rot_z, double[] vel_covariance)
            where TFrame : struct
            where TChild : struct
        {
            lock (Gate)
            {
                const string Call = "poll_odometry";
                if (!Oldest(Call, topic, out OdometryMsg odometry)
                    || !(no_covariance || (HasCovariance(Call, topic, "covariance", covariance)
                        && HasCovariance(Call, topic, "vel_covariance", vel_covariance))))
                {
                    frame_id_size = default(TFrame);
                    child_frame_id_size = default(TChild);
                    return false;
                }
                Put(Call, topic, odometry.header, ref sec, ref nanosec, frame_id, ref frame_id_size);
                Put(Call, topic, "child_frame_id", odometry.child_frame_id, child_frame_id, ref child_frame_id_size);
                x = odometry.pose.pose.position.x;
                y = odometry.pose.pose.position.y;
                z = odometry.pose.pose.position.z;
                quat_x = odometry.pose.pose.orientation.x;
                quat_y = odometry.pose.pose.orientation.y;
                quat_z = odometry.pose.pose.orientation.z;
                quat_w = odometry.pose.pose.orientation.w;
                Put(odometry.twist.twist, ref vel_x, ref vel_y, ref vel_z, ref rot_x, ref rot_y, ref rot_z);
                if (!no_covariance)
                {
                    Array.Copy(odometry.pose.covariance, covariance, CovarianceLength);
                    Array.Copy(odometry.twist.covariance, vel_covariance, CovarianceLength);
                }
                return Taken(topic, odometry);
            }
        }

        private static bool HasCovariance(string call, string topic, string part, double[] covariance)
        {
            int length = covariance == null ? 0 : covariance.Length;
            return length == CovarianceLength
                || Failed(call, topic, part + " has " + length + " values, expected " + CovarianceLength);
        }

        private static void Put(
            PoseMsg pose, double x, double y, double z, double quat_x, double quat_y, double quat_z, double quat_w)
        {
            pose.position.x = x;
            pose.position.y = y;
            pose.position.z = z;
            pose.orientation.x = quat_x;
            pose.orientation.y = quat_y;
            pose.orientation.z = quat_z;
            pose.orientation.w = quat_w;
        }

        private static void Put(
            TwistMsg twist, ref double x, ref double y, ref double z, ref double rx, ref double ry, ref double rz)
        {
            x = twist.linear.x;
            y = twist.linear.y;
            z = twist.linear.z;
            rx = twist.angular.x;
            ry = twist.angular.y;
            rz = twist.angular.z;
        }
    }
}
