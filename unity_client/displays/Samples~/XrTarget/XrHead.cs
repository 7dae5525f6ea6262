// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;
using UnityEngine;
using UnityEngine.XR;

namespace Ros2Gateway.Samples.XrTarget
{
    /// <summary>
    /// Puts the camera where the headset is, above the floor. Without a headset it stays where it is. The XR
    /// Interaction Toolkit's XR Origin does the same and more: with one, leave this out.
    /// </summary>
    public sealed class XrHead : MonoBehaviour
    {
        private readonly List<XRInputSubsystem> _subsystems = new();
        private bool _wasTracked;

        private void OnEnable()
        {
            // once more, as late as can be: what is a frame late makes sick
            Application.onBeforeRender += Follow;
        }

        private void OnDisable() => Application.onBeforeRender -= Follow;

        private void Update() => Follow();

        private void Follow()
        {
            InputDevice head = InputDevices.GetDeviceAtXRNode(XRNode.Head);
            Quaternion rotation;
            bool isTracked = head.TryGetFeatureValue(CommonUsages.centerEyePosition, out Vector3 position);
            if (isTracked && head.TryGetFeatureValue(CommonUsages.centerEyeRotation, out rotation))
            {
                transform.localPosition = position;
                transform.localRotation = rotation;
            }
            if (isTracked && !_wasTracked)
            {
                SubsystemManager.GetSubsystems(_subsystems);
                foreach (XRInputSubsystem subsystem in _subsystems)
                {
                    subsystem.TrySetTrackingOriginMode(TrackingOriginModeFlags.Floor);
                }
            }
            _wasTracked = isTracked;
        }
    }
}
