// SPDX-License-Identifier: Apache-2.0
using UnityEngine;

namespace Ros2Gateway.Samples.XrTarget
{
    /// <summary>Where an <see cref="XrTargetControl"/> learns what its user points at and wants.</summary>
    public interface IPointerInput
    {
        /// <summary>Whether there is someone: false once a headset that was worn is taken off.</summary>
        bool IsUserPresent { get; }

        /// <summary>What is pointed along, in the world.</summary>
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
