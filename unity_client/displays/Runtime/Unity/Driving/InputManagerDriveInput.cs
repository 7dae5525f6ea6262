// SPDX-License-Identifier: Apache-2.0
#if ENABLE_LEGACY_INPUT_MANAGER
using Ros2Gateway.Drive;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>The arrow keys drive and space stops, by Unity's older Input Manager.</summary>
    public sealed class InputManagerDriveInput : IDriveInput
    {
        /// <inheritdoc/>
        public DriveKeys Held =>
            DriveInputs.Keys(
                Input.GetKey(KeyCode.UpArrow), Input.GetKey(KeyCode.DownArrow),
                Input.GetKey(KeyCode.LeftArrow), Input.GetKey(KeyCode.RightArrow));

        /// <inheritdoc/>
        public bool StopPressed => Input.GetKeyDown(KeyCode.Space);
    }
}
#endif
