// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Messages.GeometryMsgs;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>Poses of the scene as ROS takes them.</summary>
    internal static class GoalPoses
    {
        /// <summary>The pose of a Transform in a fixed frame. The stamp is left to the gateway, which knows ROS' clock.</summary>
        /// <param name="fixedFrame">Null: then the scene's origin is that of *frame*.</param>
        internal static PoseStampedMsg Of(Transform place, FixedFrame fixedFrame, string frame)
        {
            PoseStampedMsg message = new();
            Pose<Flu> pose = fixedFrame == null ? place.ToPose<Flu>() : fixedFrame.PoseOf(place);
            Upright(pose).CopyTo(message.pose);
            message.header.frame_id = fixedFrame == null ? frame : fixedFrame.Frame;
            return message;
        }

        // A robot that drives takes the heading alone: what a hand tilts a little must not be refused.
        private static Pose<Flu> Upright(Pose<Flu> pose)
        {
            Quaternion<Flu> turn = pose.orientation.Normalized;
            double yaw = Math.Atan2(2 * (turn.w * turn.z + turn.x * turn.y), 1 - 2 * (turn.y * turn.y + turn.z * turn.z));
            return new Pose<Flu>(
                new Vector3<Flu>(pose.position.x, pose.position.y, 0),
                new Quaternion<Flu>(0, 0, Math.Sin(yaw / 2), Math.Cos(yaw / 2)));
        }
    }
}
