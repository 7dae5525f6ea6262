// SPDX-License-Identifier: Apache-2.0
namespace Ros2Gateway.Drive
{
    /// <summary>What a <see cref="DriveToTarget"/> is doing.</summary>
    public enum DriveState
    {
        /// <summary>There is no target, or it was taken away; the robot is told to stand.</summary>
        Idle,

        /// <summary>There is a target but no pose that is fresh; the robot is told to stand.</summary>
        Waiting,

        /// <summary>Turning on the spot towards the target.</summary>
        Turning,

        /// <summary>Driving to the target, steering on the way.</summary>
        Driving,

        /// <summary>The target is reached; the robot is told to stand.</summary>
        Done,

        /// <summary>Given up, the reason says why; the robot is told to stand.</summary>
        Failed,
    }
}
