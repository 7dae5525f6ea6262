// SPDX-License-Identifier: Apache-2.0
#if ROS2GATEWAY_INPUT_SYSTEM && ENABLE_INPUT_SYSTEM
using System.Collections.Generic;
using UnityEngine;
using UnityEngine.InputSystem;
#if ROS2GATEWAY_XR_INTERACTION
using UnityEngine.XR.Interaction.Toolkit.Interactors;
#endif

namespace Ros2Gateway.Samples.XrTarget
{
    /// <summary>
    /// Pointing by actions of the Input System, and with the XR Interaction Toolkit by one of its rays. Put
    /// it next to the <see cref="XrTargetControl"/>. Actions that are left empty are bound to every
    /// controller's trigger, touchpad or stick (clicked) and grip.
    /// </summary>
    public sealed class XrActionInput : MonoBehaviour, IPointerInput
    {
        [SerializeField]
        [Tooltip("Sends the robot to the place you point at. Empty for the trigger")]
        private InputActionReference _target;

        [SerializeField]
        [Tooltip("Takes the user to the place you point at. Empty for a click of the touchpad or stick")]
        private InputActionReference _teleport;

        [SerializeField]
        [Tooltip("Stops the robot. Empty for the grip")]
        private InputActionReference _stop;

        [SerializeField]
        [Tooltip("The pointing hand's transform. Not needed with a ray of the XR Interaction Toolkit")]
        private Transform _hand;

        private readonly List<InputAction> _own = new();
        private InputAction _targetAction;
        private InputAction _teleportAction;
        private InputAction _stopAction;

#if ROS2GATEWAY_XR_INTERACTION
        [SerializeField]
        [Tooltip("The pointing hand's ray")]
        private XRRayInteractor _ray;

        /// <summary>The pointing hand's ray.</summary>
        public XRRayInteractor RayInteractor
        {
            get => _ray;
            set => _ray = value;
        }
#endif

        /// <summary>The pointing hand's transform. Null for this one.</summary>
        public Transform Hand
        {
            get => _hand;
            set => _hand = value;
        }

        /// <summary>
        /// Sends the robot to what is pointed at. Null for the trigger. Like the others, set it before this
        /// is enabled.
        /// </summary>
        public InputActionReference Target
        {
            get => _target;
            set => _target = value;
        }

        /// <summary>Takes the user to what is pointed at. Null for the touchpad or stick, clicked.</summary>
        public InputActionReference Teleport
        {
            get => _teleport;
            set => _teleport = value;
        }

        /// <summary>Stops the robot. Null for the grip.</summary>
        public InputActionReference Stop
        {
            get => _stop;
            set => _stop = value;
        }

        /// <inheritdoc/>
        public bool IsUserPresent => !ControllerInput.HasHeadset || ControllerInput.IsHeadsetWorn;

        /// <inheritdoc/>
        public Ray Pointer
        {
            get
            {
                Transform origin = _hand != null ? _hand : transform;
#if ROS2GATEWAY_XR_INTERACTION
                if (_ray != null)
                {
                    origin = _ray.rayOriginTransform != null ? _ray.rayOriginTransform : _ray.transform;
                }
#endif
                return new Ray(origin.position, origin.forward);
            }
        }

        /// <inheritdoc/>
        public bool TargetPressed => _targetAction.WasPressedThisFrame();

        /// <inheritdoc/>
        public bool TeleportPressed => _teleportAction.WasPressedThisFrame();

        /// <inheritdoc/>
        public bool StopPressed => _stopAction.WasPressedThisFrame();

        /// <inheritdoc/>
        public void Poll()
        {
        }

        private void OnEnable()
        {
            _targetAction = Enabled(_target, "Target", "<XRController>/{TriggerButton}");
            _teleportAction = Enabled(_teleport, "Teleport", "<XRController>/{Primary2DAxisClick}");
            _stopAction = Enabled(_stop, "Stop", "<XRController>/{GripButton}");
        }

        private void OnDisable()
        {
            // Others may use the same action: it is left enabled.
            foreach (InputAction action in _own)
            {
                action.Disable();
                action.Dispose();
            }
            _own.Clear();
        }

        private InputAction Enabled(InputActionReference reference, string name, string binding)
        {
            InputAction action = reference == null ? null : reference.action;
            if (action == null)
            {
                action = new InputAction(name, InputActionType.Button, binding);
                _own.Add(action);
            }
            action.Enable();
            return action;
        }
    }
}
#endif
