// SPDX-License-Identifier: Apache-2.0
using UnityEngine;

namespace Ros2Gateway.Samples.XrTarget
{
    /// <summary>Tells an <see cref="XrTargetControl"/> where its user points, and what the user wants.</summary>
    public interface IPointerInput
    {
        /// <summary>Whether there is someone: false once a headset that was worn is taken off.</summary>
        bool IsUserPresent { get; }

        /// <summary>The ray of the pointer, in the world.</summary>
        Ray Pointer { get; }

        /// <summary>Whether the robot is sent to what is pointed at: true in one frame.</summary>
        bool TargetPressed { get; }

        /// <summary>Whether the user goes to what is pointed at: true in one frame.</summary>
        bool TeleportPressed { get; }

        /// <summary>Whether the robot must stand: true in one frame.</summary>
        bool StopPressed { get; }

        /// <summary>Reads the devices. Once per frame, before the rest is asked.</summary>
        void Poll();
    }
}
