// SPDX-License-Identifier: Apache-2.0
using UnityEngine;
#if ROS2GATEWAY_INPUT_SYSTEM && ENABLE_INPUT_SYSTEM
using UnityEngine.InputSystem;
#endif

namespace Ros2Gateway.Samples.XrTarget
{
    /// <summary>
    /// Without a headset: left button for a target, right button to teleport, space to stop.
    /// </summary>
    public sealed class MouseInput : IPointerInput
    {
        private readonly Camera _camera;

        /// <param name="camera">Through whose picture the mouse points. Null for the main one.</param>
        public MouseInput(Camera camera) => _camera = camera;

        /// <inheritdoc/>
        public bool IsUserPresent => true;

        /// <inheritdoc/>
        public Ray Pointer { get; private set; }

        /// <inheritdoc/>
        public bool TargetPressed { get; private set; }

        /// <inheritdoc/>
        public bool TeleportPressed { get; private set; }

        /// <inheritdoc/>
        public bool StopPressed { get; private set; }

        /// <inheritdoc/>
        public void Poll()
        {
            Camera camera = _camera != null ? _camera : Camera.main;
            Vector3 pixel = Vector3.zero;
#if ROS2GATEWAY_INPUT_SYSTEM && ENABLE_INPUT_SYSTEM
            Mouse mouse = Mouse.current;
            Keyboard keys = Keyboard.current;
            StopPressed = keys != null && keys.spaceKey.wasPressedThisFrame;
            TargetPressed = mouse != null && mouse.leftButton.wasPressedThisFrame;
            TeleportPressed = mouse != null && mouse.rightButton.wasPressedThisFrame;
            pixel = mouse == null ? Vector3.zero : (Vector3)mouse.position.ReadValue();
#elif ENABLE_LEGACY_INPUT_MANAGER
            StopPressed = Input.GetKeyDown(KeyCode.Space);
            TargetPressed = Input.GetMouseButtonDown(0);
            TeleportPressed = Input.GetMouseButtonDown(1);
            pixel = Input.mousePosition;
#endif
            if (camera != null)
            {
                Pointer = camera.ScreenPointToRay(pixel);
            }
        }
    }
}
