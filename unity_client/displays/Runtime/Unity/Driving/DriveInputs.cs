// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Drive;

namespace Ros2Gateway.Unity
{
    /// <summary>Chooses the keyboard that this project has.</summary>
    public static class DriveInputs
    {
        /// <summary>
        /// The arrow keys and space by the Input System where the project has it switched on, else by the
        /// Input Manager. Without either, nothing is ever held.
        /// </summary>
        public static IDriveInput Keyboard()
        {
#if ROS2GATEWAY_INPUT_SYSTEM && ENABLE_INPUT_SYSTEM
            return new InputSystemDriveInput();
#elif ENABLE_LEGACY_INPUT_MANAGER
            return new InputManagerDriveInput();
#else
            return new NoDriveInput();
#endif
        }

        /// <summary>Puts together what four keys say.</summary>
        internal static DriveKeys Keys(bool forward, bool back, bool left, bool right) =>
            (forward ? DriveKeys.Forward : 0) | (back ? DriveKeys.Back : 0)
                | (left ? DriveKeys.Left : 0) | (right ? DriveKeys.Right : 0);

#if !(ROS2GATEWAY_INPUT_SYSTEM && ENABLE_INPUT_SYSTEM) && !ENABLE_LEGACY_INPUT_MANAGER
        private sealed class NoDriveInput : IDriveInput
        {
            public DriveKeys Held => DriveKeys.None;

            public bool StopPressed => false;
        }
#endif
    }
}
