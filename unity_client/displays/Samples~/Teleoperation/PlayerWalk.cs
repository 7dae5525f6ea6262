// SPDX-License-Identifier: Apache-2.0
using UnityEngine;

namespace Ros2Gateway.Samples.Teleoperation
{
    /// <summary>
    /// A player who walks with WASD and looks around with the mouse: a click takes the pointer, Escape gives
    /// it back. This transform turns to the sides, the eyes up and down.
    /// </summary>
    public sealed class PlayerWalk : MonoBehaviour
    {
        private const float SteepestLook = 85; // degrees: straight up there is no ahead

        [SerializeField]
        [Tooltip("The camera, a child of this")]
        private Transform _eyes;

        [SerializeField]
        [Tooltip("In m/s")]
        private float _speed = 1.5f;

        [SerializeField]
        [Tooltip("In degrees a pixel")]
        private float _sensitivity = 0.1f;

        private IWalkInput _input;
        private float _pitch;

        /// <summary>The camera, a child of this.</summary>
        public Transform Eyes
        {
            get => _eyes;
            set => _eyes = value;
        }

        /// <summary>The source of walking. WASD and the mouse, unless it is set.</summary>
        public IWalkInput Input
        {
            get => _input ?? (_input = new KeyboardWalkInput());
            set => _input = value;
        }

        private void Update()
        {
            if (Input.GrabPressed)
            {
                Grab(true);
            }
            else if (Input.ReleasePressed)
            {
                Grab(false);
            }
            if (Cursor.lockState == CursorLockMode.Locked)
            {
                Look(Input.Look * _sensitivity);
            }
            Vector2 move = Input.Move;
            Vector3 way = transform.forward * move.y + transform.right * move.x;
            if (way.magnitude > 1)
            {
                way = way.normalized; // no faster aslant
            }
            transform.position += way * _speed * Time.deltaTime;
        }

        private void OnDisable() => Grab(false);

        private void Look(Vector2 degrees)
        {
            transform.Rotate(0, degrees.x, 0);
            _pitch = Mathf.Clamp(_pitch - degrees.y, -SteepestLook, SteepestLook);
            if (_eyes != null)
            {
                _eyes.localRotation = Quaternion.Euler(_pitch, 0, 0);
            }
        }

        private static void Grab(bool isGrabbed)
        {
            Cursor.lockState = isGrabbed ? CursorLockMode.Locked : CursorLockMode.None;
            Cursor.visible = !isGrabbed;
        }
    }
}
