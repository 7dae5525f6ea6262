// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Messages.SensorMsgs;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// Draws a point cloud with float32 fields x, y, z and, if it has one, rgb or rgba. It stands where
    /// the cloud's frame is if a Fixed Frame is above it. Else the Transform is the sensor's.
    /// </summary>
    [AddComponentMenu("ROS 2 Gateway/Point Cloud Display")]
    [RequireComponent(typeof(MeshFilter), typeof(MeshRenderer))]
    public sealed class PointCloudDisplay : FramedDisplay<PointCloud2Msg>
    {
        [SerializeField]
        [Tooltip("Of larger clouds every second, third ... point is drawn")]
        [Range(100, 1000000)]
        private int _maxPoints = 50000;

        [SerializeField]
        [Tooltip("Of clouds without colors")]
        private Color _color = Color.white;

        private PointMesh _mesh;

        /// <summary>Of larger clouds every second, third ... point is drawn.</summary>
        public int MaxPoints
        {
            get => _maxPoints;
            set => _maxPoints = value;
        }

        /// <summary>The colour of clouds without colours.</summary>
        public Color Color
        {
            get => _color;
            set => _color = value;
        }

        /// <summary>How many points of the newest cloud are drawn.</summary>
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
        protected override bool Draw(PointCloud2Msg message)
        {
            StandIn(message.header);
            Drawn = 0;
            PointCloudLayout layout = new();
            string refusal = layout.Read(message);
            if (refusal != null)
            {
                Warn(refusal);
                _mesh.Clear();
                return false;
            }
            if (layout.IsTruncated)
            {
                Warn("a point cloud's data end before its points");
            }
            int most = Mathf.Max(1, _maxPoints);
            long step = layout.Count > most ? (layout.Count - 1) / most + 1 : 1;
            _mesh.Reserve((int)(layout.Count / step + 1), (int)(layout.Count / step + 1));
            Color32 color = _color;
            for (long i = 0; i < layout.Count; i += step)
            {
                if (layout.TryGet(i, out Vector3<Flu> point, out Color32 own))
                {
                    _mesh.Positions[Drawn] = point.ToUnity();
                    _mesh.Colors[Drawn] = layout.HasColor ? own : color;
                    _mesh.Indices[Drawn] = Drawn;
                    Drawn++;
                }
            }
            _mesh.Upload(Drawn, Drawn, MeshTopology.Points);
            return true;
        }
    }
}
