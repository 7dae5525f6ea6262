// SPDX-License-Identifier: Apache-2.0
using UnityEngine;
#if ROS2GATEWAY_INPUT_SYSTEM && ENABLE_INPUT_SYSTEM
using UnityEngine.InputSystem;
#endif

namespace Ros2Gateway.Samples.Teleoperation
{
    /// <summary>WASD and the mouse, by the Input System where the project has it switched on.</summary>
    public sealed class KeyboardWalkInput : IWalkInput
    {
#if ROS2GATEWAY_INPUT_SYSTEM && ENABLE_INPUT_SYSTEM
        /// <inheritdoc/>
        public Vector2 Move
        {
            get
            {
                Keyboard keys = Keyboard.current;
                return keys == null ? Vector2.zero : Of(
                    keys.wKey.isPressed, keys.sKey.isPressed, keys.aKey.isPressed, keys.dKey.isPressed);
            }
        }

        /// <inheritdoc/>
        public Vector2 Look => Mouse.current == null ? Vector2.zero : Mouse.current.delta.ReadValue();

        /// <inheritdoc/>
        public bool GrabPressed => Mouse.current != null && Mouse.current.leftButton.wasPressedThisFrame;

        /// <inheritdoc/>
        public bool ReleasePressed => Keyboard.current != null && Keyboard.current.escapeKey.wasPressedThisFrame;
#elif ENABLE_LEGACY_INPUT_MANAGER
        private const float PixelsPerUnit = 20; // the scale of the Input Manager's axes for a mouse by default

        /// <inheritdoc/>
        public Vector2 Move
        {
            get
            {
                return Of(
                    Input.GetKey(KeyCode.W), Input.GetKey(KeyCode.S),
                    Input.GetKey(KeyCode.A), Input.GetKey(KeyCode.D));
            }
        }

        /// <inheritdoc/>
        public Vector2 Look
        {
            get { return new Vector2(Input.GetAxis("Mouse X"), Input.GetAxis("Mouse Y")) * PixelsPerUnit; }
        }

        /// <inheritdoc/>
        public bool GrabPressed
        {
            get { return Input.GetMouseButtonDown(0); }
        }

        /// <inheritdoc/>
        public bool ReleasePressed
        {
            get { return Input.GetKeyDown(KeyCode.Escape); }
        }
#else
        /// <inheritdoc/>
        public Vector2 Move => Of(false, false, false, false);

        /// <inheritdoc/>
        public Vector2 Look => Vector2.zero;

        /// <inheritdoc/>
        public bool GrabPressed => false;

        /// <inheritdoc/>
        public bool ReleasePressed => false;
#endif

        private static Vector2 Of(bool ahead, bool back, bool left, bool right) =>
            new Vector2((right ? 1 : 0) - (left ? 1 : 0), (ahead ? 1 : 0) - (back ? 1 : 0));
    }
}
