// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Messages.NavMsgs;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// Follows a robot by its odometry, in the odometry's frame below a Fixed Frame. Without one the parent is the origin of
    /// that frame. Never ahead of what is known: it stands where the newest message says, or is on its way there.
    /// </summary>
    [AddComponentMenu("ROS 2 Gateway/Digital Twin")]
    public sealed class DigitalTwin : FramedDisplay<OdometryMsg>
    {
        [SerializeField]
        [Tooltip("How long it takes to reach a new pose, in seconds. 0 to jump")]
        [Range(0, 1)]
        private float _smoothing = 0.1f;

        [SerializeField]
        [Tooltip("It jumps if it is further away than this, in meters. 0 for never")]
        private float _teleportDistance = 1;

        [SerializeField]
        [Tooltip("It is hidden after this time without a message, in seconds. 0 for never")]
        private float _hideAfter;

        private Pose _from;
        private Pose _to;
        private Pose _at = Pose.identity; // on the way from one to the other
        private float _since;
        private bool _hasPose;

        /// <summary>How long it takes to where a message says, in seconds. 0 to jump.</summary>
        public float Smoothing
        {
            get => _smoothing;
            set => _smoothing = value;
        }

        /// <summary>From further than this it jumps, in metres. 0 for never.</summary>
        public float TeleportDistance
        {
            get => _teleportDistance;
            set => _teleportDistance = value;
        }

        /// <summary>Without a message for so long it is not drawn, in seconds. 0 for never.</summary>
        public float HideAfter
        {
            get => _hideAfter;
            set => _hideAfter = value;
        }

        /// <inheritdoc/>
        protected override bool IsOutdated => _hideAfter > 0 && AgeSeconds > _hideAfter;

        /// <inheritdoc/>
        protected override void Update()
        {
            base.Update();
            if (_hasPose && !HasFixedFrame)
            {
                Pose pose = PoseInFrame();
                transform.localPosition = pose.position;
                transform.localRotation = pose.rotation;
            }
        }

        /// <inheritdoc/>
        protected override void OnDisable()
        {
            base.OnDisable();
            _hasPose = false; // it may be elsewhere when it is enabled again
        }

        /// <inheritdoc/>
        protected override bool Draw(OdometryMsg message)
        {
            Pose pose = message.pose.pose.As<Flu>().ToUnity();
            if (!IsFinite(pose.position.x) || !IsFinite(pose.position.y) || !IsFinite(pose.position.z))
            {
                Warn("the odometry's position is not finite");
                return false;
            }
            StandIn(message.header);
            _from = _at;
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

        /// <inheritdoc/>
        protected override Pose PoseInFrame()
        {
            float elapsed = Time.unscaledTime - _since;
            float way = _smoothing > 0 ? elapsed / _smoothing : 1; // Lerp and Slerp end at 1
            _at = new Pose(
                Vector3.Lerp(_from.position, _to.position, way), Quaternion.Slerp(_from.rotation, _to.rotation, way));
            return _at;
        }

        private static bool IsFinite(float value) => !float.IsNaN(value) && !float.IsInfinity(value);
    }
}
