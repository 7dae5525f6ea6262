// SPDX-License-Identifier: Apache-2.0
namespace Ros2Gateway
{
    /// <summary>What a publisher asks for beyond topic and type.</summary>
    public sealed class AdvertiseOptions
    {
        /// <summary>
        /// How many messages may wait for the network, the oldest being dropped. Small on purpose: a
        /// command that waited is a command for a robot that is elsewhere by now.
        /// </summary>
        public int Queue = 2;

        /// <summary>
        /// Whether late subscribers get the last message. It is also sent again after a reconnection.
        /// For what is a state (a map, a goal's marker), never for commands.
        /// </summary>
        public bool Latch;

        /// <summary>Quality of service of the ROS publisher; null for reliable with depth 10.</summary>
        public QosOptions Qos;
    }
}
