// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using Ros2Gateway.Messages.VisualizationMsgs;
using Ros2Gateway.Shapes;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// Draws the markers of a MarkerArray, each in its own frame if there is a Fixed Frame above. Else the Transform is
    /// the frame of all.
    /// </summary>
    /// <remarks>
    /// A message may add to what others have added, so each is shown when it comes. While this is disabled there are no
    /// markers, because nobody would remove those that are deleted in the meantime. Enabled again, it begins with the
    /// subscriber's last message.
    /// </remarks>
    [AddComponentMenu("ROS 2 Gateway/Marker Array Display")]
    public sealed class MarkerArrayDisplay : TypedDisplay<MarkerArrayMsg>
    {
        [SerializeField]
        [Tooltip("Empty: the one above in the hierarchy. Without any, the Transform is the markers' frame")]
        private FixedFrame _fixedFrame;

        [SerializeField]
        [Tooltip("How many markers are kept. More are left out")]
        [Range(1, 10000)]
        private int _maxMarkers = 1000; // an object of the scene each

        [SerializeField]
        [Tooltip("How many vertices they have in all (a cube has 24). Of more, only a part is drawn")]
        [Range(1000, 50000000)]
        private int _maxVertices = 1 << 22; // 16 bytes each and, as cubes, 6 of indices: 88 MB

        [SerializeField]
        [Tooltip("Of solids. Empty: one that uses the colors of vertices")]
        private Material _material;

        private readonly Dictionary<Key, MarkerObject> _markers = new();
        private readonly List<Key> _over = new();
        private readonly MeshBuffer _shapes = new();
        private readonly MeshStaging _staging = new();
        private int _vertexCount; // of all
        private FixedFrame _found;
        private Material _own; // if none was chosen

        /// <summary>In what markers are placed. A change counts when the component is enabled the next time.</summary>
        public FixedFrame FixedFrame
        {
            get => _fixedFrame;
            set => _fixedFrame = value;
        }

        /// <summary>How many markers are kept. More are left out.</summary>
        public int MaxMarkers
        {
            get => _maxMarkers;
            set => _maxMarkers = value;
        }

        /// <summary>How many vertices they have in all, a cube 24. Of more only a part is drawn.</summary>
        public int MaxVertices
        {
            get => _maxVertices;
            set => _maxVertices = value;
        }

        /// <summary>How many markers there are.</summary>
        public int Count => _markers.Count;

        /// <inheritdoc/>
        protected override bool DrawsEvery => true;

        /// <summary>Takes all markers away.</summary>
        public void Clear()
        {
            foreach (MarkerObject marker in _markers.Values)
            {
                marker.Destroy();
            }
            _markers.Clear();
            _vertexCount = 0;
        }

        /// <inheritdoc/>
        protected override void OnEnable()
        {
            base.OnEnable();
            _found = FixedFrame.For(this, _fixedFrame);
        }

        /// <inheritdoc/>
        protected override void Update()
        {
            base.Update();
            Camera camera = Camera.main;
            foreach (KeyValuePair<Key, MarkerObject> marker in _markers)
            {
                if (marker.Value.IsOver)
                {
                    _over.Add(marker.Key);
                }
                else
                {
                    marker.Value.Place(_found, camera);
                }
            }
            foreach (Key key in _over)
            {
                Remove(key);
            }
            _over.Clear();
        }

        /// <inheritdoc/>
        protected override void OnDisable()
        {
            base.OnDisable();
            Clear();
        }

        private void OnDestroy() => Destroy(_own);

        /// <inheritdoc/>
        protected override bool Draw(MarkerArrayMsg message)
        {
            MarkerMsg[] markers = message.markers ?? new MarkerMsg[0];
            for (int i = 0; i < markers.Length; i++)
            {
                if (markers[i] != null)
                {
                    Apply(markers[i]);
                }
            }
            return true;
        }

        private void Apply(MarkerMsg marker)
        {
            Key key = new(marker.ns ?? "", marker.id);
            switch (marker.action)
            {
                case MarkerMsg.ADD:
                    Add(key, marker);
                    break;
                case MarkerMsg.DELETE:
                    Remove(key);
                    break;
                case MarkerMsg.DELETEALL:
                    Clear();
                    break;
                default:
                    Warn("a marker's action " + marker.action + " is unknown");
                    break;
            }
        }

        private void Add(Key key, MarkerMsg marker)
        {
            if (!_markers.TryGetValue(key, out MarkerObject shown))
            {
                if (_markers.Count >= _maxMarkers)
                {
                    Warn("at most " + _maxMarkers + " markers: the others are left out");
                    return;
                }
                _own = _material != null ? _own : _own ?? DisplayMaterials.Solid();
                shown = new MarkerObject(transform, _material != null ? _material : _own, _staging);
                _markers[key] = shown;
            }
            _vertexCount -= shown.VertexCount;
            _shapes.Room = _maxVertices - _vertexCount;
            string problem = shown.Show(marker, _shapes);
            _vertexCount += shown.VertexCount;
            if (problem != null)
            {
                Warn("a marker: " + problem);
            }
        }

        private void Remove(Key key)
        {
            if (_markers.TryGetValue(key, out MarkerObject shown))
            {
                shown.Destroy();
                _vertexCount -= shown.VertexCount;
                _markers.Remove(key);
            }
        }

        private struct Key : IEquatable<Key>
        {
            private readonly string _namespace;
            private readonly int _id;

            internal Key(string space, int id)
            {
                _namespace = space;
                _id = id;
            }

            public bool Equals(Key other) => _id == other._id && _namespace == other._namespace;

            public override bool Equals(object obj) => obj is Key && Equals((Key)obj);

            public override int GetHashCode() => unchecked(_namespace.GetHashCode() * 397 ^ _id);
        }
    }
}
