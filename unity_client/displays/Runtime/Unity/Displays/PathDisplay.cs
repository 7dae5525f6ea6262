// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Messages.NavMsgs;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>Draws a path as a line, in the frame of its header.</summary>
    [AddComponentMenu("ROS 2 Gateway/Path Display")]
    [RequireComponent(typeof(MeshFilter), typeof(MeshRenderer))]
    public sealed class PathDisplay : FramedDisplay<PathMsg>
    {
        private const int MaxPoses = 65536; // a hundred times a planner's. Longer paths are thinned out

        [SerializeField]
        private Color _color = new(0.1f, 0.8f, 0.2f);

        private PointMesh _mesh;

        /// <summary>The colour, from the next path on.</summary>
        public Color Color
        {
            get => _color;
            set => _color = value;
        }

        /// <summary>How many poses of the newest path are drawn.</summary>
        public int Drawn { get; private set; }

        /// <inheritdoc/>
        protected override void OnEnable()
        {
            base.OnEnable();
            _mesh ??= new PointMesh(this);
        }

        private void OnDestroy()
        {
            if (_mesh != null)
            {
                _mesh.Destroy();
                _mesh = null;
            }
        }

        /// <inheritdoc/>
        protected override bool Draw(PathMsg message)
        {
            StandIn(message.header);
            Drawn = 0;
            PoseStampedMsg[] poses = message.poses ?? new PoseStampedMsg[0]; // an empty path is how planners clear theirs
            int step = poses.Length > MaxPoses ? (poses.Length - 1) / MaxPoses + 1 : 1;
            _mesh.Reserve(poses.Length / step + 2, 2 * (poses.Length / step + 2));
            int indices = 0;
            bool isJoined = false;
            for (int i = 0; i < poses.Length; i += step)
            {
                if (!TryAdd(poses[i]))
                {
                    Warn("a path's pose is not finite: the line has a gap");
                    isJoined = false;
                    continue;
                }
                if (isJoined)
                {
                    _mesh.Indices[indices++] = Drawn - 2;
                    _mesh.Indices[indices++] = Drawn - 1;
                }
                isJoined = true;
            }
            _mesh.Upload(Drawn, indices, MeshTopology.Lines);
            return true;
        }

        private bool TryAdd(PoseStampedMsg pose)
        {
            if (pose == null || pose.pose == null || pose.pose.position == null)
            {
                return false;
            }
            Vector3<Flu> at = pose.pose.position.As<Flu>();
            if (!(at.Length <= float.MaxValue)) // false for NaN as well
            {
                return false;
            }
            _mesh.Positions[Drawn] = at.ToUnity();
            _mesh.Colors[Drawn] = _color;
            Drawn++;
            return true;
        }
    }
}
