// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Messages;
using Ros2Gateway.Messages.SensorMsgs;
using Ros2Gateway.Pictures;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>Draws a depth camera's picture as points, where the camera sees them.</summary>
    /// <remarks>
    /// The subscriber's type is sensor_msgs/msg/Image and its Image Format png: then depth comes in millimetres. Pictures
    /// are decoded on the main thread. Let the subscriber ask for a width and a rate that are enough.
    /// </remarks>
    [AddComponentMenu("ROS 2 Gateway/Depth Display")]
    [RequireComponent(typeof(MeshFilter), typeof(MeshRenderer))]
    public sealed class DepthDisplay : FramedDisplay<CompressedImageMsg>
    {
        [SerializeField]
        [Tooltip("How much the camera sees from left to right, in degrees, until it is told by a CameraInfo")]
        [Range(1, 179)]
        private float _horizontalView = 60;

        [SerializeField]
        [Tooltip("Points further away are left out, in meters. 0 for no limit")]
        private float _maxRange;

        [SerializeField]
        [Tooltip("Of larger pictures every second, third ... row and column is drawn")]
        [Range(100, 1000000)]
        private int _maxPoints = 50000;

        [SerializeField]
        private Color _nearColor = Color.red;

        [SerializeField]
        private Color _farColor = Color.blue;

        private PointMesh _mesh;
        private DepthPoints _points;

        /// <summary>Points further away are left out, in metres. 0 for no limit. From the next image on.</summary>
        public float MaxRange
        {
            get => _maxRange;
            set => _maxRange = value;
        }

        /// <summary>Of larger pictures every second, third ... row and column is drawn.</summary>
        public int MaxPoints
        {
            get => _maxPoints;
            set => _maxPoints = value;
        }

        /// <summary>How many points of the newest picture are drawn.</summary>
        public int Drawn { get; private set; }

        /// <summary>Takes what the camera says of itself. Another subscriber's On Message may call it.</summary>
        public void SetCamera(IMessage message)
        {
            _points ??= new DepthPoints(_horizontalView * Mathf.Deg2Rad); // not enabled yet
            CameraInfoMsg info = message as CameraInfoMsg;
            string problem = info == null ? "SetCamera needs a sensor_msgs/msg/CameraInfo" : _points.View(info);
            if (problem != null)
            {
                Warn(problem);
            }
        }

        /// <inheritdoc/>
        protected override void OnEnable()
        {
            MessageCatalogue.Register<CameraInfoMsg>(); // for the subscriber that calls SetCamera
            base.OnEnable();
            _mesh ??= new PointMesh(this);
            _points ??= new DepthPoints(_horizontalView * Mathf.Deg2Rad);
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
        protected override bool Draw(CompressedImageMsg message)
        {
            StandIn(message.header);
            Drawn = 0;
            string problem = _points.Read(message.data);
            if (problem != null)
            {
                Warn(problem + ": set the subscriber's Image Format to png");
                _mesh.Clear();
                return false;
            }
            int step = 1;
            while (((_points.Width - 1) / step + 1) * ((_points.Height - 1) / step + 1) > Mathf.Max(1, _maxPoints))
            {
                step++;
            }
            int most = ((_points.Width - 1) / step + 1) * ((_points.Height - 1) / step + 1);
            _mesh.Reserve(most, most);
            float farthest = _maxRange > 0 ? _maxRange : float.MaxValue;
            float scale = _maxRange > 0 ? _maxRange : 10; // metres: what such cameras reach
            for (int y = 0; y < _points.Height; y += step)
            {
                for (int x = 0; x < _points.Width; x += step)
                {
                    if (_points.TryGet(x, y, out Vector3<Flu> point) && point.z <= farthest)
                    {
                        _mesh.Positions[Drawn] = point.ToUnity();
                        _mesh.Colors[Drawn] = Color.Lerp(_nearColor, _farColor, Mathf.Clamp01((float)point.z / scale));
                        _mesh.Indices[Drawn] = Drawn;
                        Drawn++;
                    }
                }
            }
            _mesh.Upload(Drawn, Drawn, MeshTopology.Points);
            return true;
        }
    }
}
