// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Messages.SensorMsgs;
using Ros2Gateway.Pictures;
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
    /// Shows pictures, JPEG or PNG, on the Renderer or the RawImage next to it. The newest only. For
    /// sensor_msgs/msg/CompressedImage, and for sensor_msgs/msg/Image, which the gateway sends as JPEG.
    /// </summary>
    /// <remarks>
    /// Baseline JPEGs, as cameras and the gateway make them, are decoded on another thread as soon as they
    /// arrive. Update uploads the newest that is decoded, one at most. Progressive JPEGs and PNGs, and in WebGL,
    /// which has no threads, all pictures are decoded by Unity on the main thread.
    /// </remarks>
    [AddComponentMenu("ROS 2 Gateway/Image Screen")]
    public sealed class ImageScreen : TypedDisplay<CompressedImageMsg>
    {
        private const int MaxSide = 8192; // pixels: what small GPUs take. As a texture already 256 MB
        private const float LookSeconds = 1;
        private const float Dim = 0.35f; // of the brightness: plainly not live, and still to be made out

        [SerializeField]
        [Tooltip("Make it as wide as the image needs. The height stays")]
        private bool _keepAspect = true;

        [SerializeField]
        [Tooltip("Ask for images as large as the main camera sees it, of sensor_msgs/msg/Image, as JPEG. Turn it "
            + "off if your script needs the Topic Subscriber's images as they are")]
        private bool _shrinksToView = true;

        [SerializeField]
        [Tooltip("It counts as stale after this time without an image, in seconds")]
        [Range(0.1f, 60)]
        private float _staleAfter = 2;

        [SerializeField]
        [Tooltip("Darken a stale image")]
        private bool _dimWhenStale = true;

        [SerializeField]
        [Tooltip("Called with true when images stop arriving, with false when they arrive again")]
        private FlagEvent _onStale = new();

        [SerializeField]
        [Tooltip("Says \"no image\", or how old it is. A TextMesh Pro, Text or TextMesh below this one shows it")]
        private TextOutput _status = new();

#if UNITY_WEBGL && !UNITY_EDITOR
        private static readonly bool HasThreads = false;
#else
        private static readonly bool HasThreads = true;
#endif

        private static readonly CompressedImageMsg NoPicture = new();

        private readonly BackgroundDecoder _decoder = new();
        private readonly Listeners<bool> _staleChanged;
        private PictureSurface _surface;
        private Texture2D _texture;
        private bool _isStale;
        private int _statusSeconds;
        private float _nextLook;

        /// <summary>A component of the scene. Made by Unity.</summary>
        public ImageScreen()
        {
            _staleChanged = new Listeners<bool>(ReportFault, "listener of On Stale");
            _staleChanged.Add(isStale => _onStale.Invoke(isStale));
        }

        /// <summary>The picture. Null before the first. This component uses it again.</summary>
        public Texture2D Texture => _texture;

        /// <summary>Whether no picture has come for so long that the present one may mislead.</summary>
        public bool IsStale => _isStale;

        /// <summary>Without a picture for so long it counts as stale, in seconds.</summary>
        public float StaleAfter
        {
            get => _staleAfter;
            set => _staleAfter = value;
        }

        /// <summary>Whether it is made as wide as the picture demands.</summary>
        public bool KeepAspect
        {
            get => _keepAspect;
            set => _keepAspect = value;
        }

        /// <summary>Whether it asks for no larger pictures than the main camera sees of it.</summary>
        public bool ShrinksToView
        {
            get => _shrinksToView;
            set => _shrinksToView = value;
        }

        /// <summary>Called with true when pictures stay away, with false when they come again.</summary>
        public FlagEvent OnStale => _onStale;

        /// <summary>"no image", how old it is, or nothing.</summary>
        public TextOutput Status => _status;

        /// <inheritdoc/>
        protected override void OnEnable()
        {
            base.OnEnable();
            _surface ??= new PictureSurface(this);
            if (!_surface.Exists)
            {
                Warn("finds no Renderer and no RawImage on its object: add one");
            }
            _status.Find(this, false);
            if (HasThreads)
            {
                Subscriber.MessageArriving += Decode;
            }
            SetStale(true); // last, for who is told may disable this
        }

        /// <inheritdoc/>
        protected override void Update()
        {
            base.Update();
            AskForShownSize();
            Upload();
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
        protected override void OnDisable()
        {
            base.OnDisable();
            Subscriber.MessageArriving -= Decode;
            Subscriber.ShownSide = 0; // others may show its pictures
            _nextLook = 0;
        }

        /// <inheritdoc/>
        protected override CompressedImageMsg Converted(IMessage message)
        {
            PictureMsg picture = message as PictureMsg;
            if (picture == null)
            {
                return base.Converted(message);
            }
            return HasThreads ? NoPicture : picture.Copy(); // with threads it is decoded already, see Receive
        }

        /// <inheritdoc/>
        protected override void Receive(CompressedImageMsg message)
        {
            if (!HasThreads)
            {
                base.Receive(message); // else it went to the decoder when it arrived
            }
        }

        /// <summary>Has a picture decoded, which is shown once it is. False until then.</summary>
        protected override bool Draw(CompressedImageMsg message)
        {
            if (HasThreads)
            {
                _decoder.Offer(message.data, message.format);
                return false;
            }
            return LoadImage(message.data, message.format);
        }

        private void AskForShownSize()
        {
            float now = Time.unscaledTime;
            if (now >= _nextLook)
            {
                _nextLook = now + LookSeconds;
                float pixels = _shrinksToView ? _surface.PixelsAcross(Camera.main) : float.PositiveInfinity;
                Subscriber.ShownSide = PictureBound.Next(Subscriber.ShownSide, pixels);
            }
        }

        private void Decode(IMessage message)
        {
            CompressedImageMsg picture = message as CompressedImageMsg;
            PictureMsg filledAnew = message as PictureMsg;
            if (filledAnew != null)
            {
                _decoder.Offer(filledAnew.buffer, filledAnew.count, filledAnew.format);
            }
            else if (picture != null)
            {
                _decoder.Offer(picture.data, picture.format);
            }
        }

        private void Upload()
        {
            DecodedPicture picture = _decoder.Take();
            if (picture == null)
            {
                return;
            }
            bool isShown = picture.IsOther
                ? LoadImage(picture.Compressed(), picture.Format)
                : UploadPixels(picture);
            if (isShown)
            {
                SetDrawn((float)picture.AgeSeconds);
            }
            _decoder.GiveBack(picture);
        }

        private bool UploadPixels(DecodedPicture picture)
        {
            if (picture.Error != null)
            {
                Warn("an image of format \"" + picture.Format + "\" is damaged: " + picture.Error);
                return false;
            }
            if (!Fits(picture.Width, picture.Height))
            {
                return false;
            }
            // four bytes a pixel, as GPUs have it: nothing is converted on the way
            const TextureFormat Format = TextureFormat.RGBA32;
            if (_texture == null)
            {
                _texture = new Texture2D(picture.Width, picture.Height, Format, false);
            }
            else if (_texture.width != picture.Width || _texture.height != picture.Height
                || _texture.format != Format)
            {
                _texture.Reinitialize(picture.Width, picture.Height, Format, false);
            }
            _texture.LoadRawTextureData(picture.Pixels);
            _texture.Apply(false);
            ShowTexture();
            return true;
        }

        private bool LoadImage(byte[] picture, string format)
        {
            if (picture == null || !PictureSize.TryRead(picture, out int width, out int height))
            {
                Warn("cannot show an image of format \"" + format + "\": JPEG and PNG only");
                return false;
            }
            if (!Fits(width, height))
            {
                return false;
            }
            _texture ??= new Texture2D(2, 2, TextureFormat.RGB24, false);
            if (!_texture.LoadImage(picture))
            {
                Warn("an image of format \"" + format + "\" is damaged");
                return false;
            }
            ShowTexture();
            return true;
        }

        private bool Fits(int width, int height)
        {
            if (width <= MaxSide && height <= MaxSide)
            {
                return true;
            }
            Warn("an image has " + width + " x " + height + " pixels, at most " + MaxSide + " each way");
            return false;
        }

        private void ShowTexture()
        {
            _surface.Show(_texture);
            if (_keepAspect)
            {
                _surface.KeepAspect((float)_texture.width / _texture.height);
            }
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
            _staleChanged.Call(isStale);
        }

        private void TellAge()
        {
            int seconds = _texture == null ? 0 : (int)Mathf.Min(AgeSeconds, int.MaxValue / 2);
            if (seconds != _statusSeconds)
            {
                _statusSeconds = seconds;
                _status.Show(_texture == null ? "no image" : "image is " + seconds + " s old");
            }
        }
    }
}
