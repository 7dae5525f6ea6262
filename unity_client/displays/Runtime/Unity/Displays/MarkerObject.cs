// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Messages.VisualizationMsgs;
using Ros2Gateway.Shapes;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>One marker of a display: its own object, which is shown again and used again.</summary>
    internal sealed class MarkerObject
    {
        private const int TextResolution = 48; // pixels a letter
        private const float TextSize = 10f / TextResolution; // a TextMesh of size 1 has letters of a tenth of a metre

        private readonly GameObject _object;
        private readonly PointMesh _mesh;
        private TextMesh _text;
        private Pose _pose;
        private string _frame;
        private float _until;
        private bool _isUsable;

        /// <param name="material">That all markers of a display share.</param>
        /// <param name="staging">That they share as well.</param>
        internal MarkerObject(Transform parent, Material material, MeshStaging staging)
        {
            _object = new GameObject("Marker", typeof(MeshFilter), typeof(MeshRenderer));
            _object.transform.SetParent(parent, false);
            _object.SetActive(false); // until it has its place
            _object.GetComponent<MeshRenderer>().sharedMaterial = material;
            _mesh = new PointMesh(_object.transform, true, staging);
        }

        /// <summary>Whether its lifetime is over.</summary>
        internal bool IsOver => Time.unscaledTime >= _until;

        /// <summary>How many vertices its mesh has.</summary>
        internal int VertexCount { get; private set; }

        /// <summary>Shows a marker. Returns what is wrong with it, or null.</summary>
        internal string Show(MarkerMsg marker, MeshBuffer shapes)
        {
            double seconds = marker.lifetime == null ? 0 : marker.lifetime.sec + marker.lifetime.nanosec * 1e-9;
            _until = seconds > 0 ? Time.unscaledTime + (float)seconds : float.PositiveInfinity;
            _frame = marker.header == null ? "" : marker.header.frame_id;
            string problem = MarkerShapes.Build(marker, shapes);
            Pose<Flu> pose = marker.pose == null ? new Pose<Flu>() : marker.pose.As<Flu>();
            _isUsable = pose.position.Length <= float.MaxValue; // false for NaN as well
            if (!_isUsable)
            {
                _object.SetActive(false);
                return "its pose is not finite";
            }
            _pose = pose.ToUnity();
            _object.name = marker.ns + "/" + marker.id;
            _mesh.Upload(shapes);
            VertexCount = shapes.VertexCount;
            ShowText(marker);
            return problem;
        }

        /// <summary>Puts it where its frame is. Without a known place it is not drawn.</summary>
        /// <param name="fixedFrame">Null: the parent is the frame.</param>
        internal void Place(FixedFrame fixedFrame, Camera camera)
        {
            if (!_isUsable)
            {
                return;
            }
            Pose frame = Pose.identity;
            bool isKnown = fixedFrame == null || fixedFrame.TryGetPose(_frame, out frame, out float age, out string problem);
            _object.SetActive(isKnown);
            if (!isKnown)
            {
                return;
            }
            Pose pose = new(frame.position + frame.rotation * _pose.position, frame.rotation * _pose.rotation);
            if (fixedFrame == null)
            {
                _object.transform.localPosition = pose.position;
                _object.transform.localRotation = pose.rotation;
            }
            else
            {
                fixedFrame.Place(_object.transform, pose);
            }
            if (_text != null && camera != null)
            {
                _text.transform.rotation = camera.transform.rotation; // so that it can be read
            }
        }

        internal void Destroy()
        {
            _mesh.Destroy();
            Object.Destroy(_object);
        }

        private void ShowText(MarkerMsg marker)
        {
            if (!marker.IsText())
            {
                if (_text != null)
                {
                    Object.Destroy(_text.gameObject);
                    _text = null;
                }
                return;
            }
            if (_text == null)
            {
                GameObject holder = new("Text", typeof(TextMesh));
                holder.transform.SetParent(_object.transform, false);
                _text = holder.GetComponent<TextMesh>();
                _text.anchor = TextAnchor.MiddleCenter;
                _text.fontSize = TextResolution;
                _text.richText = false; // publishers of markers should not style the application
            }
            _text.text = marker.text;
            _text.characterSize = TextSize * (float)marker.scale.z;
            Rgba color = Rgba.Of(marker.color);
            _text.color = new Color32(color.r, color.g, color.b, color.a);
        }
    }
}
