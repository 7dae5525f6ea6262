// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Messages.NavMsgs;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>Draws where a robot has been, by its odometry.</summary>
    [AddComponentMenu("ROS 2 Gateway/Odometry Trail")]
    [RequireComponent(typeof(MeshFilter), typeof(MeshRenderer))]
    public sealed class OdometryTrail : FramedDisplay<OdometryMsg>
    {
        [SerializeField]
        private Color _color = new(0.2f, 0.6f, 1f);

        [SerializeField]
        [Tooltip("A point each time that the robot has come so far, in meters")]
        private float _spacing = 0.05f;

        [SerializeField]
        [Tooltip("How many points are kept. The oldest are dropped")]
        [Range(2, 65536)]
        private int _maxPoints = 2000; // 100 m at 5 cm

        [SerializeField]
        [Tooltip("A jump of more than this begins a new trail, in meters. 0 for never")]
        private float _teleportDistance = 1;

        private PointMesh _mesh;
        private Vector3[] _points = new Vector3[0]; // a ring
        private int _first;
        private string _frame;

        /// <summary>The colour, from the next message on.</summary>
        public Color Color
        {
            get => _color;
            set => _color = value;
        }

        /// <summary>A point each time that the robot has come so far, in metres.</summary>
        public float Spacing
        {
            get => _spacing;
            set => _spacing = value;
        }

        /// <summary>How many points are kept. A change begins a new trail.</summary>
        public int MaxPoints
        {
            get => _maxPoints;
            set => _maxPoints = value;
        }

        /// <summary>A jump of more than this begins a new trail, in metres. 0 for never.</summary>
        public float TeleportDistance
        {
            get => _teleportDistance;
            set => _teleportDistance = value;
        }

        /// <summary>How many points the trail has.</summary>
        public int Count { get; private set; }

        /// <summary>Begins a new trail.</summary>
        public void Clear()
        {
            Count = 0;
            _first = 0;
            if (_mesh != null)
            {
                _mesh.Clear();
            }
        }

        /// <inheritdoc/>
        protected override void OnEnable()
        {
            base.OnEnable();
            if (_mesh == null)
            {
                _mesh = new PointMesh(this);
                Upload(); // when scripts were reloaded the points are still there
            }
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
        protected override bool Draw(OdometryMsg message)
        {
            StandIn(message.header);
            Vector3<Flu> read = message.pose.pose.position.As<Flu>();
            if (!(read.Length <= float.MaxValue)) // false for NaN as well
            {
                Warn("the odometry's position is not finite");
                return false;
            }
            Vector3 at = read.ToUnity();
            if (_frame != FrameId || _points.Length != Mathf.Max(2, _maxPoints))
            {
                _frame = FrameId;
                _points = new Vector3[Mathf.Max(2, _maxPoints)];
                Clear();
            }
            float way = Count == 0 ? float.PositiveInfinity : Vector3.Distance(at, Newest());
            if (_teleportDistance > 0 && Count > 0 && way > _teleportDistance)
            {
                Clear();
            }
            if (way >= _spacing)
            {
                Keep(at);
                Upload();
            }
            return true;
        }

        private Vector3 Newest() => _points[(_first + Count - 1) % _points.Length];

        private void Keep(Vector3 at)
        {
            if (Count == _points.Length)
            {
                _first = (_first + 1) % _points.Length;
                Count--;
            }
            _points[(_first + Count) % _points.Length] = at;
            Count++;
        }

        private void Upload()
        {
            if (Count == 0)
            {
                return;
            }
            _mesh.Reserve(_points.Length, 2 * _points.Length);
            for (int i = 0; i < Count; i++)
            {
                _mesh.Positions[i] = _points[(_first + i) % _points.Length];
                _mesh.Colors[i] = _color;
                _mesh.Indices[2 * i] = i;
                _mesh.Indices[2 * i + 1] = i + 1;
            }
            _mesh.Upload(Count, 2 * (Count - 1), MeshTopology.Lines);
        }
    }
}
