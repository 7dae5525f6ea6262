// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Maps;
using Ros2Gateway.Messages.NavMsgs;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>Draws a map or a costmap flat on the ground, a pixel a cell.</summary>
    /// <remarks>The cells come as a PNG, which the subscriber asks the gateway for.</remarks>
    [AddComponentMenu("ROS 2 Gateway/Occupancy Grid Display")]
    [RequireComponent(typeof(MeshFilter), typeof(MeshRenderer))]
    public sealed class OccupancyGridDisplay : FramedDisplay<OccupancyGridMsg>, IAsks
    {
        [SerializeField]
        private OccupancyGridColors _colors = OccupancyGridColors.Map;

        [SerializeField]
        [Tooltip("How opaque, 0 to 1")]
        [Range(0, 1)]
        private float _alpha = 1;

        [SerializeField]
        [Tooltip("How far above its origin, in meters: what lies at the same height flickers")]
        private float _height;

        private readonly Vector3[] _corners = new Vector3[4];
        private readonly Color32[] _tints = new Color32[4];
        private OccupancyGridPixels _pixels;
        private OccupancyGridColors _pixelColors;
        private Mesh _mesh;
        private Material _material;
        private Texture2D _texture;

        /// <summary>The look of cells, from the next message on.</summary>
        public OccupancyGridColors Colors
        {
            get => _colors;
            set => _colors = value;
        }

        /// <summary>How opaque, 0 to 1, from the next message on.</summary>
        public float Alpha
        {
            get => _alpha;
            set => _alpha = value;
        }

        /// <summary>How far above its origin, in metres, from the next message on.</summary>
        public float Height
        {
            get => _height;
            set => _height = value;
        }

        /// <summary>The picture, its first row at the map's origin. Null before the first map.</summary>
        public Texture2D Texture => _texture;

        void IAsks.Ask(string type, SubscribeOptions options)
        {
            if (type == OccupancyGridMsg.Type)
            {
                OccupancyGridPng.Ask(options);
            }
        }

        private void Awake()
        {
            _mesh = new Mesh();
            _mesh.name = name;
            GetComponent<MeshFilter>().sharedMesh = _mesh;
            MeshRenderer renderer = GetComponent<MeshRenderer>();
            // a separate one: the texture must not get into a material of the project
            _material = renderer.sharedMaterial == null
                ? DisplayMaterials.Flat() : new Material(renderer.sharedMaterial);
            renderer.sharedMaterial = _material;
            renderer.shadowCastingMode = UnityEngine.Rendering.ShadowCastingMode.Off;
        }

        private void OnDestroy()
        {
            Destroy(_mesh);
            Destroy(_material);
            Destroy(_texture);
        }

        /// <inheritdoc/>
        protected override bool Draw(OccupancyGridMsg message)
        {
            StandIn(message.header);
            if (_pixels == null || _pixelColors != _colors)
            {
                _pixels = new OccupancyGridPixels(_colors);
                _pixelColors = _colors;
            }
            string problem = _pixels.Draw(message) ?? Spread(message.info);
            if (problem != null)
            {
                Warn(problem);
                _mesh.Clear();
                return false;
            }
            Paint();
            return true;
        }

        private string Spread(MapMetaDataMsg info)
        {
            Pose<Flu> read = info.origin == null ? new Pose<Flu>() : info.origin.As<Flu>();
            Pose<Flu> origin = new(
                read.position + new Vector3<Flu>(0, 0, _height), read.orientation.Normalized);
            if (double.IsNaN(origin.position.Length) || double.IsInfinity(origin.position.Length))
            {
                return "the grid's origin is not finite";
            }
            // the pixels may reach beyond the last cell, where several cells share one
            double pixel = (double)info.resolution * _pixels.CellsPerPixel;
            double width = pixel * _pixels.Width, height = pixel * _pixels.Height;
            for (int i = 0; i < 4; i++)
            {
                Vector3<Flu> corner = new(i == 1 || i == 2 ? width : 0, i >= 2 ? height : 0, 0);
                _corners[i] = (origin * corner).ToUnity();
                _tints[i] = new Color32(255, 255, 255, (byte)(255 * Mathf.Clamp01(_alpha)));
            }
            return null;
        }

        private void Paint()
        {
            if (_texture == null)
            {
                _texture = new Texture2D(_pixels.Width, _pixels.Height, TextureFormat.RGBA32, false);
                _texture.filterMode = FilterMode.Point; // a cell is a square
                _texture.wrapMode = TextureWrapMode.Clamp;
            }
            else if (_texture.width != _pixels.Width || _texture.height != _pixels.Height)
            {
                _texture.Reinitialize(_pixels.Width, _pixels.Height);
            }
            _texture.LoadRawTextureData(_pixels.Pixels);
            _texture.Apply(false);
            _mesh.Clear();
            _mesh.SetVertices(_corners, 0, 4);
            _mesh.SetColors(_tints, 0, 4);
            _mesh.uv = new[] { Vector2.zero, new Vector2(1, 0), Vector2.one, new Vector2(0, 1) };
            _mesh.SetIndices(new[] { 0, 2, 1, 0, 3, 2 }, MeshTopology.Triangles, 0); // clockwise from above
            _material.mainTexture = _texture;
        }
    }
}
