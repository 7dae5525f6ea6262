// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Messages.SensorMsgs;
using UnityEngine;
using UnityEngine.Events;

namespace Ros2Gateway.Unity
{
    /// <summary>Yes or no, for the Inspector's lists of what to call.</summary>
    [Serializable]
    public sealed class FlagEvent : UnityEvent<bool>
    {
    }

    /// <summary>
    /// Shows pictures, JPEG or PNG, on the Renderer or the RawImage beside it; the newest only. For
    /// sensor_msgs/msg/CompressedImage, and for sensor_msgs/msg/Image, which the gateway sends as JPEG.
    /// </summary>
    [AddComponentMenu("ROS 2 Gateway/Image Screen")]
    public sealed class ImageScreen : TopicDisplay<CompressedImageMsg>
    {
        private const int MaxSide = 8192; // pixels: what small GPUs take; as a texture already 256 MB
        private const float Dim = 0.35f; // of the brightness: plainly not live, and still to be made out

        [SerializeField]
        [Tooltip("Make it as wide as the picture demands; the height stays")]
        private bool _keepAspect = true;

        [SerializeField]
        [Tooltip("Without a picture for so long it counts as stale, in seconds")]
        [Range(0.1f, 60)]
        private float _staleAfter = 2;

        [SerializeField]
        [Tooltip("Darken a picture that is stale")]
        private bool _dimWhenStale = true;

        [SerializeField]
        [Tooltip("Called with true when pictures stay away, with false when they come again")]
        private FlagEvent _onStale = new FlagEvent();

        [SerializeField]
        [Tooltip("Says \"no picture\", or how old it is; a TextMesh or Text below this one shows it")]
        private TextOutput _status = new TextOutput();

        private PictureSurface _surface;
        private Texture2D _texture;
        private bool _isStale;
        private int _statusSeconds;

        /// <summary>The picture; null before the first. This component uses it again.</summary>
        public Texture2D Texture
        {
            get { return _texture; }
        }

        /// <summary>Whether no picture has come for so long that the present one may mislead.</summary>
        public bool IsStale
        {
            get { return _isStale; }
        }

        /// <summary>Without a picture for so long it counts as stale, in seconds.</summary>
        public float StaleAfter
        {
            get { return _staleAfter; }
            set { _staleAfter = value; }
        }

        /// <summary>Whether it is made as wide as the picture demands.</summary>
        public bool KeepAspect
        {
            get { return _keepAspect; }
            set { _keepAspect = value; }
        }

        /// <summary>Called with true when pictures stay away, with false when they come again.</summary>
        public FlagEvent OnStale
        {
            get { return _onStale; }
        }

        /// <summary>"no picture", how old it is, or nothing.</summary>
        public TextOutput Status
        {
            get { return _status; }
        }

        /// <inheritdoc/>
        protected override void OnEnable()
        {
            base.OnEnable();
            if (_surface == null)
            {
                _surface = new PictureSurface(this);
            }
            if (!_surface.Exists)
            {
                Complain("finds no Renderer and no RawImage beside it");
            }
            _status.Find(this, false);
            SetStale(true);
        }

        /// <inheritdoc/>
        protected override void Update()
        {
            base.Update();
            bool isStale = _texture == null || AgeSeconds > _staleAfter;
            if (isStale != _isStale)
            {
                SetStale(isStale);
            }
            if (isStale)
            {
                TellAge();
            }
        }

        /// <inheritdoc/>
        protected override bool Draw(CompressedImageMsg message)
        {
            int width;
            int height;
            if (message.data == null || !PictureSize.TryRead(message.data, out width, out height))
            {
                Complain("cannot show a picture of format \"" + message.format + "\": JPEG and PNG only");
                return false;
            }
            if (width > MaxSide || height > MaxSide)
            {
                Complain(
                    "a picture has " + width + " x " + height + " pixels, at most " + MaxSide + " each way");
                return false;
            }
            if (_texture == null)
            {
                _texture = new Texture2D(2, 2, TextureFormat.RGB24, false);
            }
            if (!_texture.LoadImage(message.data))
            {
                Complain("a picture of format \"" + message.format + "\" is damaged");
                return false;
            }
            _surface.Show(_texture);
            if (_keepAspect)
            {
                _surface.KeepAspect((float)_texture.width / _texture.height);
            }
            return true;
        }

        private void OnDestroy()
        {
            if (_surface != null)
            {
                _surface.Destroy();
            }
            Destroy(_texture);
        }

        private void SetStale(bool isStale)
        {
            _isStale = isStale;
            _statusSeconds = -1;
            if (_texture != null && _dimWhenStale)
            {
                _surface.Darken(isStale ? Dim : 1);
            }
            if (!isStale)
            {
                _status.Show("");
            }
            _onStale.Invoke(isStale);
        }

        private void TellAge()
        {
            int seconds = _texture == null ? 0 : (int)Mathf.Min(AgeSeconds, int.MaxValue / 2);
            if (seconds != _statusSeconds)
            {
                _statusSeconds = seconds;
                _status.Show(_texture == null ? "no picture" : "picture is " + seconds + " s old");
            }
        }
    }
}
