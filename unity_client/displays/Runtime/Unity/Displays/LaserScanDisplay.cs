// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Messages.SensorMsgs;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>How a scan is drawn.</summary>
    public enum LaserScanStyle
    {
        /// <summary>The points that the beams hit, a pixel each.</summary>
        Points,

        /// <summary>The points that the beams hit, joined if neighbours seem to hit the same thing.</summary>
        Outline,

        /// <summary>The beams, from the sensor to what they hit.</summary>
        Beams,
    }

    /// <summary>The meaning of the colours of a scan.</summary>
    public enum LaserScanColoring
    {
        /// <summary>How far away something is: the near colour at 0, the far one at the limit.</summary>
        Distance,

        /// <summary>How much came back: the far colour at 0, the near one at the scan's maximum.</summary>
        Intensity,
    }

    /// <summary>Draws a laser scan. Below a Fixed Frame where the scan's frame is. Else the Transform is the sensor's.</summary>
    [AddComponentMenu("ROS 2 Gateway/Laser Scan Display")]
    [RequireComponent(typeof(MeshFilter), typeof(MeshRenderer))]
    public sealed class LaserScanDisplay : FramedDisplay<LaserScanMsg>
    {
        private const int MaxBeams = 65536; // ten times what scanners have. More are thinned out
        private const float SameThing = 0.1f; // of the range: neighbours that differ more are not joined

        [SerializeField]
        private LaserScanStyle _style = LaserScanStyle.Outline;

        [SerializeField]
        private LaserScanColoring _coloring = LaserScanColoring.Distance;

        [SerializeField]
        private Color _nearColor = Color.red;

        [SerializeField]
        private Color _farColor = Color.green;

        [SerializeField]
        [Tooltip("Points further away are left out, in meters. 0 for the limit of the scanner")]
        private float _maxRange;

        private PointMesh _mesh;
        private Vector3[] _directions = new Vector3[0];
        private int _directionCount;
        private float _angle;
        private float _increment;

        /// <summary>How a scan is drawn, from the next on.</summary>
        public LaserScanStyle Style
        {
            get => _style;
            set => _style = value;
        }

        /// <summary>The meaning of the colours, from the next scan on.</summary>
        public LaserScanColoring Coloring
        {
            get => _coloring;
            set => _coloring = value;
        }

        /// <summary>Points further away are left out, in metres. 0 for the scanner's own limit.</summary>
        public float MaxRange
        {
            get => _maxRange;
            set => _maxRange = value;
        }

        /// <summary>How many beams of the newest scan hit something within the limits.</summary>
        public int Hits { get; private set; }

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
        protected override bool Draw(LaserScanMsg message)
        {
            StandIn(message.header);
            Hits = 0;
            float[] ranges = message.ranges;
            if (ranges == null || ranges.Length == 0)
            {
                _mesh.Clear();
                return true;
            }
            int step = (ranges.Length - 1) / MaxBeams + 1;
            int beams = (ranges.Length - 1) / step + 1;
            if (!Aim(message.angle_min, message.angle_increment * step, beams))
            {
                Warn("the scan's angles are not finite");
                _mesh.Clear();
                return false;
            }
            _mesh.Reserve(beams + 1, 2 * beams);
            Hits = Place(message, step, beams);
            bool isOfPoints = _style == LaserScanStyle.Points;
            _mesh.Upload(Hits + 1, Join(Hits), isOfPoints ? MeshTopology.Points : MeshTopology.Lines);
            return true;
        }

        /// <summary>Finds the beams' directions, unless they are those of the last scan.</summary>
        private bool Aim(float angle, float increment, int count)
        {
            if (angle == _angle && increment == _increment && count <= _directionCount)
            {
                return true;
            }
            double end = (double)angle + (double)increment * count;
            if (double.IsNaN(end) || double.IsInfinity(end))
            {
                return false;
            }
            if (_directions.Length < count)
            {
                _directions = new Vector3[count];
            }
            for (int i = 0; i < count; i++)
            {
                double at = angle + (double)increment * i;
                _directions[i] = new Vector3<Flu>(Math.Cos(at), Math.Sin(at), 0).ToUnity();
            }
            _angle = angle;
            _increment = increment;
            _directionCount = count;
            return true;
        }

        /// <summary>Puts the sensor at 0, the hits behind it. Returns how many hits there are.</summary>
        private int Place(LaserScanMsg message, int step, int beams)
        {
            // without its own limits (0, NaN or infinite) all that was measured counts
            float least = message.range_min > 0 ? message.range_min : 0;
            float most = message.range_max > 0 ? Mathf.Min(message.range_max, float.MaxValue) : float.MaxValue;
            most = _maxRange > 0 ? Mathf.Min(most, _maxRange) : most;
            float[] intensities = message.intensities;
            bool isByIntensity = _coloring == LaserScanColoring.Intensity
                && intensities != null && intensities.Length == message.ranges.Length;
            float scale = isByIntensity ? Largest(intensities) : FarthestOf(message.ranges, most);
            int hits = 0;
            _mesh.Positions[0] = Vector3.zero;
            _mesh.Colors[0] = _nearColor;
            for (int i = 0; i < beams; i++)
            {
                float range = message.ranges[i * step];
                if (!(range >= least && range <= most)) // false for NaN as well
                {
                    continue;
                }
                float share = isByIntensity ? 1 - intensities[i * step] / scale : range / scale;
                hits++;
                _mesh.Positions[hits] = _directions[i] * range;
                _mesh.Colors[hits] = Color.Lerp(_nearColor, _farColor, Mathf.Clamp01(share));
            }
            return hits;
        }

        private int Join(int hits)
        {
            int[] indices = _mesh.Indices;
            int count = 0;
            for (int hit = 1; hit <= hits; hit++)
            {
                if (_style == LaserScanStyle.Points)
                {
                    indices[count++] = hit;
                }
                else if (_style == LaserScanStyle.Beams)
                {
                    indices[count++] = 0;
                    indices[count++] = hit;
                }
                else if (hit > 1 && AreOfOneThing(_mesh.Positions[hit - 1], _mesh.Positions[hit]))
                {
                    indices[count++] = hit - 1;
                    indices[count++] = hit;
                }
            }
            return count;
        }

        private static bool AreOfOneThing(Vector3 one, Vector3 other) => (one - other).magnitude <= SameThing * one.magnitude;

        private static float Largest(float[] values)
        {
            float largest = float.Epsilon; // dividing by it is safe
            for (int i = 0; i < values.Length; i++)
            {
                largest = values[i] > largest && values[i] <= float.MaxValue ? values[i] : largest;
            }
            return largest;
        }

        private static float FarthestOf(float[] ranges, float most) => most < float.MaxValue ? most : Largest(ranges);
    }
}
