// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Messages.GeometryMsgs;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>Draws a PoseArray, such as the particles of a localisation, as arrows.</summary>
    [AddComponentMenu("ROS 2 Gateway/Pose Array Display")]
    [RequireComponent(typeof(MeshFilter), typeof(MeshRenderer))]
    public sealed class PoseArrayDisplay : FramedDisplay<PoseArrayMsg>
    {
        [SerializeField]
        private Color _color = new(0.9f, 0.5f, 0.1f);

        [SerializeField]
        [Tooltip("How long an arrow is, in meters")]
        private float _length = 0.2f;

        private PoseArrows _arrows;

        /// <summary>The colour, from the next message on.</summary>
        public Color Color
        {
            get => _color;
            set => _color = value;
        }

        /// <summary>How long an arrow is, in metres, from the next message on.</summary>
        public float Length
        {
            get => _length;
            set => _length = value;
        }

        /// <summary>How many poses of the newest message are drawn.</summary>
        public int Drawn { get; private set; }

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
        protected override bool Draw(PoseArrayMsg message)
        {
            StandIn(message.header);
            Drawn = 0;
            _arrows.Begin(_length, _color);
            PoseMsg[] poses = message.poses ?? new PoseMsg[0];
            for (int i = 0; i < poses.Length && !_arrows.IsTruncated; i++)
            {
                if (_arrows.Add(poses[i]))
                {
                    Drawn++;
                }
                else
                {
                    Warn("some of the poses are not finite, and are left out");
                }
            }
            if (_arrows.IsTruncated)
            {
                Drawn--; // the last found no room
                Warn("too many poses: the first " + Drawn + " are drawn");
            }
            _arrows.Upload();
            return true;
        }
    }
}
