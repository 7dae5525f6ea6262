// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;
using Ros2Gateway.Messages.NavMsgs;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// Follows a robot by its odometry; the parent is the origin of its frame. Never ahead of what is known:
    /// it stands where the newest message says, or is on its way there.
    /// </summary>
    [AddComponentMenu("ROS 2 Gateway/Digital Twin")]
    public sealed class DigitalTwin : TopicDisplay<OdometryMsg>
    {
        [SerializeField]
        [Tooltip("How long it takes to where a message says, in seconds; 0 to jump")]
        [Range(0, 1)]
        private float _smoothing = 0.1f;

        [SerializeField]
        [Tooltip("From further than this it jumps, in metres; 0 for never")]
        private float _teleportDistance = 1;

        [SerializeField]
        [Tooltip("Without a message for so long it is not drawn, in seconds; 0 for never")]
        private float _hideAfter;

        private readonly List<Renderer> _hidden = new List<Renderer>();
        private Pose _from;
        private Pose _to;
        private float _since;
        private bool _hasPose;
        private bool _isHidden;

        /// <summary>How long it takes to where a message says, in seconds; 0 to jump.</summary>
        public float Smoothing
        {
            get { return _smoothing; }
            set { _smoothing = value; }
        }

        /// <summary>From further than this it jumps, in metres; 0 for never.</summary>
        public float TeleportDistance
        {
            get { return _teleportDistance; }
            set { _teleportDistance = value; }
        }

        /// <summary>Without a message for so long it is not drawn, in seconds; 0 for never.</summary>
        public float HideAfter
        {
            get { return _hideAfter; }
            set { _hideAfter = value; }
        }

        /// <summary>Whether it is not drawn because the newest message is too old.</summary>
        public bool IsHidden
        {
            get { return _isHidden; }
        }

        /// <inheritdoc/>
        protected override void Update()
        {
            base.Update();
            if (_hasPose)
            {
                Move();
            }
            bool isHidden = _hideAfter > 0 && AgeSeconds > _hideAfter;
            if (isHidden != _isHidden)
            {
                Hide(isHidden);
            }
        }

        /// <inheritdoc/>
        protected override void OnDisable()
        {
            base.OnDisable();
            _hasPose = false; // it may be elsewhere when it is enabled again
            Hide(false);
        }

        /// <inheritdoc/>
        protected override bool Draw(OdometryMsg message)
        {
            Pose pose = message.pose.pose.As<Flu>().ToUnity();
            if (!IsFinite(pose.position.x) || !IsFinite(pose.position.y) || !IsFinite(pose.position.z))
            {
                Complain("the odometry's position is not finite");
                return false;
            }
            _from = new Pose(transform.localPosition, transform.localRotation);
            _to = pose;
            _since = Time.unscaledTime - Time.unscaledDeltaTime; // this frame moves it already
            bool isFar = _teleportDistance > 0
                && Vector3.Distance(_from.position, _to.position) > _teleportDistance;
            if (isFar || !_hasPose)
            {
                _from = _to;
            }
            _hasPose = true;
            return true;
        }

        private void Move()
        {
            float elapsed = Time.unscaledTime - _since;
            float way = _smoothing > 0 ? elapsed / _smoothing : 1; // Lerp and Slerp end at 1
            transform.localPosition = Vector3.Lerp(_from.position, _to.position, way);
            transform.localRotation = Quaternion.Slerp(_from.rotation, _to.rotation, way);
        }

        private void Hide(bool isHidden)
        {
            _isHidden = isHidden;
            if (isHidden)
            {
                foreach (Renderer part in GetComponentsInChildren<Renderer>())
                {
                    if (part.enabled)
                    {
                        part.enabled = false;
                        _hidden.Add(part);
                    }
                }
                return;
            }
            foreach (Renderer part in _hidden)
            {
                if (part != null)
                {
                    part.enabled = true;
                }
            }
            _hidden.Clear();
        }

        private static bool IsFinite(float value)
        {
            return !float.IsNaN(value) && !float.IsInfinity(value);
        }
    }
}
