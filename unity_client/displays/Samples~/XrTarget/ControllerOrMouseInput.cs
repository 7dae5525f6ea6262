// SPDX-License-Identifier: Apache-2.0
using UnityEngine;

namespace Ros2Gateway.Samples.XrTarget
{
    /// <summary>
    /// A headset's controllers, or the mouse as long as there has been no headset: once there was one, its
    /// loss is the user's absence.
    /// </summary>
    public sealed class ControllerOrMouseInput : IPointerInput
    {
        private readonly ControllerInput _controllers;
        private IPointerInput _current;

        /// <param name="space">The tracking space. Null for the world.</param>
        /// <param name="head">The camera's. Null for the main one.</param>
        public ControllerOrMouseInput(Transform space, Transform head)
        {
            _controllers = new ControllerInput(space);
            _current = new MouseInput(head == null ? null : head.GetComponent<Camera>());
        }

        /// <inheritdoc/>
        public bool IsUserPresent => _current.IsUserPresent;

        /// <inheritdoc/>
        public Ray Pointer => _current.Pointer;

        /// <inheritdoc/>
        public bool TargetPressed => _current.TargetPressed;

        /// <inheritdoc/>
        public bool TeleportPressed => _current.TeleportPressed;

        /// <inheritdoc/>
        public bool StopPressed => _current.StopPressed;

        /// <inheritdoc/>
        public void Poll()
        {
            if (ControllerInput.HasHeadset)
            {
                _current = _controllers;
            }
            _current.Poll();
        }
    }
}
