// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Shapes;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>Poses as arrows, which point along the poses' x.</summary>
    internal sealed class PoseArrows
    {
        private const double ShaftShare = 0.7; // of the length. The rest is the head
        private const double ShaftWidth = 0.08;
        private const double HeadWidth = 0.24;

        private readonly MeshBuffer _shapes = new();
        private readonly PointMesh _mesh;
        private double _length;
        private Rgba _color;

        /// <param name="display">Has a MeshFilter and a MeshRenderer next to it.</param>
        internal PoseArrows(Component display) => _mesh = new PointMesh(display, true);

        internal bool IsTruncated => _shapes.IsTruncated;

        internal void Begin(float length, Color color)
        {
            _length = length;
            _color = Rgba.Of(color.r, color.g, color.b, color.a);
            _shapes.Clear(MeshKind.Triangles);
        }

        /// <summary>Adds a pose. False if it is not finite.</summary>
        internal bool Add(PoseMsg message)
        {
            if (message == null || message.position == null || message.orientation == null)
            {
                return false;
            }
            Pose<Flu> pose = message.As<Flu>();
            if (!(pose.position.Length <= float.MaxValue)) // false for NaN as well
            {
                return false;
            }
            _shapes.Arrow(
                new Pose<Flu>(pose.position, pose.orientation.Normalized), ShaftShare * _length, ShaftWidth * _length,
                (1 - ShaftShare) * _length, HeadWidth * _length, _color);
            return true;
        }

        internal void Upload() => _mesh.Upload(_shapes);

        internal void Destroy() => _mesh.Destroy();
    }
}
