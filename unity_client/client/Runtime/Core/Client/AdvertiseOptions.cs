// SPDX-License-Identifier: Apache-2.0
namespace Ros2Gateway
{
    /// <summary>The options of a publisher beyond topic and type.</summary>
    public sealed class AdvertiseOptions
    {
        /// <summary>As in ROS: 10.</summary>
        public const int DefaultQueue = 10;

        /// <summary>
        /// How many messages may wait for the network from frame to frame, before the oldest is dropped. Messages
        /// of the last two frames wait in addition, up to 1024 messages and 1 MiB. 1 is always the
        /// newest alone, and so it is for Twist and TwistStamped, whatever this says. A command that waited is a
        /// command for a robot that is elsewhere by now.
        /// </summary>
        public int Queue = DefaultQueue;

        /// <summary>
        /// Whether late subscribers get the last message. It is also sent again after a reconnection.
        /// For what is a state (a map, a goal's marker), never for commands: no Twist or TwistStamped is sent again.
        /// </summary>
        public bool Latch;

        /// <summary>Quality of service of the ROS publisher. Null for reliable with depth 10.</summary>
        public QosOptions Qos;
    }
}
