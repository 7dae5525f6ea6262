// SPDX-License-Identifier: Apache-2.0
#if ROS2GATEWAY_INPUT_SYSTEM && ENABLE_INPUT_SYSTEM
using Ros2Gateway.Drive;
using UnityEngine.InputSystem;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// The arrow keys drive and space stops, by the Input System. Without a keyboard nothing does.
    /// </summary>
    public sealed class InputSystemDriveInput : IDriveInput
    {
        /// <inheritdoc/>
        public DriveKeys Held
        {
            get
            {
                Keyboard keyboard = Keyboard.current;
                return keyboard == null ? DriveKeys.None : DriveInputs.Keys(
                    keyboard.upArrowKey.isPressed, keyboard.downArrowKey.isPressed,
                    keyboard.leftArrowKey.isPressed, keyboard.rightArrowKey.isPressed);
            }
        }

        /// <inheritdoc/>
        public bool StopPressed
        {
            get
            {
                Keyboard keyboard = Keyboard.current;
                return keyboard != null && keyboard.spaceKey.wasPressedThisFrame;
            }
        }
    }
}
#endif
