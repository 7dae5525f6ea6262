// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Json;
using Ros2Gateway.Messages.GeometryMsgs;

namespace Ros2Gateway
{
    /// <summary>The messages that can move a robot.</summary>
    internal static class Velocities
    {
        /// <summary>Whether messages of a type can.</summary>
        internal static bool IsType(string type)
        {
            return type == TwistMsg.Type || type == TwistStampedMsg.Type;
        }

        /// <summary>
        /// Whether a message says to stand. True also for classes of the application's, which cannot be looked
        /// into: the gateway can.
        /// </summary>
        internal static bool MayBeZero(IMessage message)
        {
            TwistMsg twist = message as TwistMsg;
            TwistStampedMsg stamped = message as TwistStampedMsg;
            DynamicMessage tree = message as DynamicMessage;
            if (stamped != null)
            {
                twist = stamped.twist;
            }
            if (twist != null)
            {
                return IsZero(twist.linear) && IsZero(twist.angular);
            }
            if (tree == null || tree.Value == null)
            {
                return true;
            }
            JsonValue value = tree.RosType == TwistMsg.Type ? tree.Value : tree.Value["twist"];
            return IsZero(value["linear"]) && IsZero(value["angular"]);
        }

        private static bool IsZero(Vector3Msg vector)
        {
            return vector == null || (vector.x == 0 && vector.y == 0 && vector.z == 0);
        }

        private static bool IsZero(JsonValue vector)
        {
            return vector["x"].AsDouble(0) == 0 && vector["y"].AsDouble(0) == 0 && vector["z"].AsDouble(0) == 0;
        }
    }
}
