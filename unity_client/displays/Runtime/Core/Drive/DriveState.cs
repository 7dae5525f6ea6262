// SPDX-License-Identifier: Apache-2.0
namespace Ros2Gateway.Drive
{
    /// <summary>The activity of a <see cref="DriveToTarget"/>.</summary>
    public enum DriveState
    {
        /// <summary>There is no target, or it was taken away. The robot is told to stand.</summary>
        Idle,

        /// <summary>There is a target but no pose that is fresh. The robot is told to stand.</summary>
        Waiting,

        /// <summary>Turning on the spot towards the target.</summary>
        Turning,

        /// <summary>Driving to the target, steering on the way.</summary>
        Driving,

        /// <summary>The target is reached. The robot is told to stand.</summary>
        Done,

        /// <summary>Given up, the reason says why. The robot is told to stand.</summary>
        Failed,
    }
}
