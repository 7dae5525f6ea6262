// SPDX-License-Identifier: Apache-2.0
using UnityEngine;

namespace Ros2Gateway.Samples.Teleoperation
{
    /// <summary>Tells a <see cref="PlayerWalk"/> where its player goes and looks.</summary>
    public interface IWalkInput
    {
        /// <summary>To the right and ahead, each from -1 to 1.</summary>
        Vector2 Move { get; }

        /// <summary>How far the mouse moved since the last frame, in pixels: to the right and up.</summary>
        Vector2 Look { get; }

        /// <summary>Whether looking around began in this frame: the mouse was pressed.</summary>
        bool GrabPressed { get; }

        /// <summary>Whether the mouse pointer is wanted back: Escape.</summary>
        bool ReleasePressed { get; }
    }
}
