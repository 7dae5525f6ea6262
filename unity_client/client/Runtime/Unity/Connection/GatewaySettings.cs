// SPDX-License-Identifier: Apache-2.0
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>The address of the gateway, as an asset that several scenes share.</summary>
    [CreateAssetMenu(menuName = "ROS 2 Gateway/Settings", fileName = "GatewaySettings")]
    public sealed class GatewaySettings : ScriptableObject
    {
        /// <summary>ws://HOST:PORT, or wss://.</summary>
        [Tooltip("ws://HOST:PORT, as the gateway prints it when it starts")]
        public string Address = "ws://localhost:9090";

        /// <summary>The token for the gateway, if it needs one.</summary>
        [Tooltip("Leave empty unless the gateway needs one. It becomes part of the build: prefer to set it at run time")]
        public string Token = "";

        /// <summary>Without any word for so long the connection counts as dead, in seconds.</summary>
        [Range(1, 60)]
        public float SilenceSeconds = 6;

        /// <summary>How much of each frame may go into handling messages, in milliseconds.</summary>
        [Range(0.5f, 20)]
        public float PumpMilliseconds = 4;

        /// <summary>The its own options client.</summary>
        public GatewayOptions Options() =>
            new GatewayOptions
            {
                Address = Address,
                Token = Token,
                SilenceMilliseconds = (int)(SilenceSeconds * 1000),
                HeartbeatMilliseconds = (int)(SilenceSeconds * 1000 / 3),
            };
    }
}
