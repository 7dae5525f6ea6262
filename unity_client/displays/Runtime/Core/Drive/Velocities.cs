// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Json;
using Ros2Gateway.Messages.GeometryMsgs;

namespace Ros2Gateway
{
    /// <summary>The messages that can move a robot.</summary>
    internal static class Velocities
    {
        /// <summary>
        /// Whether a message says to stand. True also for classes of the application's, which cannot be looked
        /// into: the gateway can.
        /// </summary>
        internal static bool MayBeZero(IMessage message) => message switch
        {
            TwistMsg twist => IsZero(twist),
            TwistStampedMsg stamped => stamped.twist == null || IsZero(stamped.twist),
            DynamicMessage { Value: not null } tree =>
                IsZero(tree.RosType == TwistMsg.Type ? tree.Value : tree.Value["twist"]),
            _ => true,
        };

        private static bool IsZero(TwistMsg twist) => IsZero(twist.linear) && IsZero(twist.angular);

        private static bool IsZero(Vector3Msg vector) => vector == null || (vector.x == 0 && vector.y == 0 && vector.z == 0);

        private static bool IsZero(JsonValue twist) => HasNoLength(twist["linear"]) && HasNoLength(twist["angular"]);

        private static bool HasNoLength(JsonValue vector) =>
            vector["x"].AsDouble(0) == 0 && vector["y"].AsDouble(0) == 0 && vector["z"].AsDouble(0) == 0;
    }
}
