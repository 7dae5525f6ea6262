// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Messages.GeometryMsgs;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>Draws a PoseStamped, such as a goal, as an arrow.</summary>
    [AddComponentMenu("ROS 2 Gateway/Pose Display")]
    [RequireComponent(typeof(MeshFilter), typeof(MeshRenderer))]
    public sealed class PoseDisplay : FramedDisplay<PoseStampedMsg>
    {
        [SerializeField]
        private Color _color = new(0.9f, 0.2f, 0.6f);

        [SerializeField]
        [Tooltip("How long the arrow is, in meters")]
        private float _length = 0.5f;

        private PoseArrows _arrows;

        /// <summary>The colour, from the next pose on.</summary>
        public Color Color
        {
            get => _color;
            set => _color = value;
        }

        /// <summary>How long the arrow is, in metres, from the next pose on.</summary>
        public float Length
        {
            get => _length;
            set => _length = value;
        }

        /// <inheritdoc/>
        protected override void OnEnable()
        {
            base.OnEnable();
            _arrows ??= new PoseArrows(this);
        }

        private void OnDestroy()
        {
            if (_arrows != null)
            {
                _arrows.Destroy();
                _arrows = null;
            }
        }

        /// <inheritdoc/>
        protected override bool Draw(PoseStampedMsg message)
        {
            StandIn(message.header);
            _arrows.Begin(_length, _color);
            bool isDrawn = _arrows.Add(message.pose);
            if (!isDrawn)
            {
                Warn("the pose is not finite");
            }
            _arrows.Upload();
            return isDrawn;
        }
    }
}
