// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Unity;
using UnityEngine;

namespace Ros2Gateway.Samples.XrTarget
{
    /// <summary>
    /// Sends the robot to where the user points (trigger), teleports the user (touchpad or stick) and stops
    /// the robot (grip). A headset that is taken off stops it as well. Focus, pause and connection are the
    /// <see cref="TargetDriver"/>'s own business.
    /// </summary>
    public sealed class XrTargetControl : MonoBehaviour
    {
        private const float Level = 0.7f; // of a normal's height: what is steeper than 45 degrees is a wall

        [SerializeField]
        private TargetDriver _driver;

        [SerializeField]
        [Tooltip("Teleporting moves this: the tracking space, with the head somewhere in it")]
        private Transform _rig;

        [SerializeField]
        [Tooltip("The camera")]
        private Transform _head;

        [SerializeField]
        [Tooltip("Shows the pointing ray. May be empty")]
        private LineRenderer _line;

        [SerializeField]
        [Tooltip("How far one can point, in meters")]
        private float _reach = 20;

        [SerializeField]
        [Tooltip("The layers that you can point at")]
        private LayerMask _layers = Physics.DefaultRaycastLayers;

        private const float FocusSeconds = 0.2f; // the click that gives a window the focus is not meant for the floor

        private IPointerInput _input;
        private bool _wasPresent;
        private float _readyAt;

        /// <summary>The driver of the robot.</summary>
        public TargetDriver Driver
        {
            get => _driver;
            set => _driver = value;
        }

        /// <summary>The object that teleporting moves.</summary>
        public Transform Rig
        {
            get => _rig;
            set => _rig = value;
        }

        /// <summary>The camera.</summary>
        public Transform Head
        {
            get => _head;
            set => _head = value;
        }

        /// <summary>Shows what is pointed along. May be null.</summary>
        public LineRenderer Line
        {
            get => _line;
            set => _line = value;
        }

        /// <summary>
        /// The source of pointing: a component next to this one (such as XrActionInput), else a headset's
        /// controllers or the mouse, unless it is set.
        /// </summary>
        public IPointerInput Input
        {
            get
            {
                _input ??= GetComponent<IPointerInput>() ?? new ControllerOrMouseInput(_rig, _head);
                return _input;
            }

            set => _input = value;
        }

        private void OnApplicationFocus(bool hasFocus) => _readyAt = Time.unscaledTime + FocusSeconds;

        private void OnDisable()
        {
            if (_driver != null)
            {
                _driver.Abandon("the input that stops it was disabled"); // the scene may end while another client drives
            }
        }

        private void Update()
        {
            Input.Poll();
            bool isPresent = Input.IsUserPresent;
            if (_wasPresent && !isPresent)
            {
                _driver.Abandon("the headset was taken off");
            }
            _wasPresent = isPresent;
            if (Input.StopPressed)
            {
                _driver.Stop("the grip was pressed");
            }
            bool isHit = Physics.Raycast(Input.Pointer, out RaycastHit hit, _reach, _layers);
            Show(isHit ? hit.point : Input.Pointer.GetPoint(_reach));
            if (!isHit || !isPresent || Input.StopPressed || Time.unscaledTime < _readyAt)
            {
                return;
            }
            if (Input.TargetPressed)
            {
                _driver.SetTarget(hit.point);
            }
            if (Input.TeleportPressed && hit.normal.y > Level)
            {
                Teleport(hit.point);
            }
        }

        private void Teleport(Vector3 place)
        {
            // The user's feet go there, wherever in the tracking space they are.
            Vector3 feet = new(_head.position.x, _rig.position.y, _head.position.z);
            _rig.position += place - feet;
        }

        private void Show(Vector3 end)
        {
            if (_line != null)
            {
                _line.SetPosition(0, Input.Pointer.origin);
                _line.SetPosition(1, end);
            }
        }
    }
}
