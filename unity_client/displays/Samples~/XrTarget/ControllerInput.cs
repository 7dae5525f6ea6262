// SPDX-License-Identifier: Apache-2.0
using System;
using UnityEngine;
using UnityEngine.XR;

namespace Ros2Gateway.Samples.XrTarget
{
    /// <summary>
    /// The controllers of a headset by Unity's own XR input, so with every plug-in. Trigger, grip, and a
    /// touchpad that is clicked (Vive) or a stick that is clicked or pushed ahead (Quest). The hand that
    /// pressed last points.
    /// </summary>
    public sealed class ControllerInput : IPointerInput
    {
        private const float Pushed = 0.7f; // of a stick's way ahead
        private const float Released = 0.4f; // well below, so that a trembling thumb teleports once

        private readonly Transform _space;
        private readonly Hand _left = new(XRNode.LeftHand);
        private readonly Hand _right = new(XRNode.RightHand);
        private Hand _pointing;

        /// <param name="space">The tracking space, which the devices' poses are relative to. Null for the
        /// world.</param>
        public ControllerInput(Transform space)
        {
            _space = space;
            _pointing = _right;
        }

        /// <summary>Whether there is a headset at all.</summary>
        public static bool HasHeadset => InputDevices.GetDeviceAtXRNode(XRNode.Head).isValid;

        /// <summary>
        /// Whether there is a headset and someone wears it. One without a sensor for that is always worn.
        /// </summary>
        public static bool IsHeadsetWorn
        {
            get
            {
                InputDevice head = InputDevices.GetDeviceAtXRNode(XRNode.Head);
                return head.isValid
                    && (!head.TryGetFeatureValue(CommonUsages.userPresence, out bool isWorn) || isWorn);
            }
        }

        /// <inheritdoc/>
        public bool IsUserPresent => IsHeadsetWorn;

        /// <inheritdoc/>
        public Ray Pointer
        {
            get
            {
                Vector3 position = _pointing.Position;
                Vector3 direction = _pointing.Rotation * Vector3.forward;
                return _space == null
                    ? new Ray(position, direction)
                    : new Ray(_space.TransformPoint(position), _space.TransformDirection(direction));
            }
        }

        /// <inheritdoc/>
        public bool TargetPressed => _left.Trigger.IsPressed || _right.Trigger.IsPressed;

        /// <inheritdoc/>
        public bool TeleportPressed => _left.Pad.IsPressed || _right.Pad.IsPressed;

        /// <inheritdoc/>
        public bool StopPressed => _left.Grip.IsPressed || _right.Grip.IsPressed;

        /// <inheritdoc/>
        public void Poll()
        {
            _left.Poll();
            _right.Poll();
            if (_right.IsAnyPressed)
            {
                _pointing = _right;
            }
            else if (_left.IsAnyPressed)
            {
                _pointing = _left;
            }
        }

        /// <summary>A button that is pressed in the frame in which it goes down.</summary>
        private sealed class Button
        {
            private readonly bool _countsAtOnce;
            private bool _isDown;
            private bool _isKnown;

            /// <param name="countsAtOnce">Whether it was pressed as well, if it is down when its controller
            /// wakes: a stop, but not what sets something going.</param>
            internal Button(bool countsAtOnce) => _countsAtOnce = countsAtOnce;

            internal bool IsPressed { get; private set; }

            internal bool IsDown => _isDown;

            internal void Set(bool isDown)
            {
                IsPressed = isDown && !_isDown && (_isKnown || _countsAtOnce);
                _isDown = isDown;
                _isKnown = true;
            }

            internal void Forget()
            {
                IsPressed = false;
                _isDown = false;
                _isKnown = false;
            }
        }

        private sealed class Hand
        {
            internal readonly Button Trigger = new(false);
            internal readonly Button Grip = new(true);
            internal readonly Button Pad = new(false);

            private readonly XRNode _node;

            internal Hand(XRNode node) => _node = node;

            internal Vector3 Position { get; private set; }

            internal Quaternion Rotation { get; private set; } = Quaternion.identity;

            internal bool IsAnyPressed => Trigger.IsPressed || Grip.IsPressed || Pad.IsPressed;

            internal void Poll()
            {
                InputDevice device = InputDevices.GetDeviceAtXRNode(_node);
                if (!device.isValid)
                {
                    Trigger.Forget();
                    Grip.Forget();
                    Pad.Forget();
                    return;
                }
                if (device.TryGetFeatureValue(CommonUsages.devicePosition, out Vector3 position))
                {
                    Position = position;
                }
                if (device.TryGetFeatureValue(CommonUsages.deviceRotation, out Quaternion rotation))
                {
                    Rotation = rotation;
                }
                Trigger.Set(Is(device, CommonUsages.triggerButton));
                Grip.Set(Is(device, CommonUsages.gripButton));
                Pad.Set(Is(device, CommonUsages.primary2DAxisClick) || IsPushed(device));
            }

            private bool IsPushed(InputDevice device)
            {
                // A thumb that rests on a touchpad pushes nothing.
                return device.TryGetFeatureValue(CommonUsages.primary2DAxis, out Vector2 axis)
                    && axis.y > (Pad.IsDown ? Released : Pushed)
                    && device.name.IndexOf("vive", StringComparison.OrdinalIgnoreCase) < 0;
            }

            private static bool Is(InputDevice device, InputFeatureUsage<bool> usage) =>
                device.TryGetFeatureValue(usage, out bool isDown) && isDown;
        }
    }
}
