// SPDX-License-Identifier: Apache-2.0
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// Publishes what a camera of the scene sees, or a texture, by the Topic Publisher next to it: as JPEG, at
    /// its rate, size and quality.
    /// </summary>
    [AddComponentMenu("ROS 2 Gateway/Texture Publisher")]
    [RequireComponent(typeof(TopicPublisher))]
    public sealed class TexturePublisher : MonoBehaviour, INewestOnly
    {
        private const int DepthBits = 24; // as Unity's own cameras

        [SerializeField]
        [Tooltip("A camera for this alone: it renders into a texture instead of to the screen")]
        private Camera _camera;

        [SerializeField]
        [Tooltip("Without a camera: what is published, such as a Render Texture")]
        private Texture _source;

        [SerializeField]
        [Tooltip("The header's frame")]
        private string _frameId = "camera";

        [SerializeField]
        [Tooltip("The size of the image, in pixels, unless the camera has a target texture")]
        private Vector2 _cameraSize = new(640, 480);

        [SerializeField]
        [Tooltip("Render the camera only when an image is due, unless it has a target texture, which other objects "
            + "may show. Turn it off if your render pipeline does not support Camera.Render")]
        private bool _rendersOnDemand = true;

        private TextureStream _stream;
        private RenderTexture _rendered;
        private bool _isOnDemand; // the camera is disabled by this

        bool INewestOnly.IsNewestOnly => true;

        /// <summary>Whose picture is published. Before the component is enabled.</summary>
        public Camera Camera
        {
            get => _camera;
            set => _camera = value;
        }

        /// <summary>The texture that is published without a camera.</summary>
        public Texture Source
        {
            get => _source;
            set => _source = value;
        }

        /// <summary>
        /// Whether the camera is rendered only when a picture is due, if it has no target texture. Before the
        /// component is enabled.
        /// </summary>
        public bool RendersOnDemand
        {
            get => _rendersOnDemand;
            set => _rendersOnDemand = value;
        }

        /// <summary>The header's frame.</summary>
        public string FrameId
        {
            get => _frameId;
            set => _frameId = value;
        }

        internal TextureStream Stream => _stream ??= new TextureStream(GetComponent<TopicPublisher>());

        // In the editor, when the component is added: a publisher that suits pictures.
        private void Reset() => SceneParts.PublishPictures(GetComponent<TopicPublisher>());

        private void OnEnable()
        {
            if (_camera != null && _camera.targetTexture == null)
            {
                int width = Mathf.Max(1, Mathf.RoundToInt(_cameraSize.x));
                int height = Mathf.Max(1, Mathf.RoundToInt(_cameraSize.y));
                _rendered = new RenderTexture(width, height, DepthBits);
                _camera.targetTexture = _rendered;
                _isOnDemand = _rendersOnDemand && _camera.enabled;
                _camera.enabled = _camera.enabled && !_isOnDemand;
            }
        }

        private void LateUpdate()
        {
            if (_isOnDemand && _camera != null && Stream.IsDue)
            {
                _camera.Render();
            }
            // an enabled camera's picture is that of the frame before
            Texture texture = _camera != null ? _camera.targetTexture : _source;
            if (texture != null)
            {
                Stream.Publish(texture, _frameId);
            }
        }

        private void OnDisable()
        {
            if (_rendered == null)
            {
                return;
            }
            if (_camera != null && _camera.targetTexture == _rendered)
            {
                _camera.targetTexture = null;
            }
            if (_camera != null && _isOnDemand)
            {
                _camera.enabled = true;
            }
            _isOnDemand = false;
            _rendered.Release();
            Destroy(_rendered);
            _rendered = null;
        }

        private void OnDestroy()
        {
            if (_stream != null)
            {
                _stream.Destroy();
            }
        }
    }
}
