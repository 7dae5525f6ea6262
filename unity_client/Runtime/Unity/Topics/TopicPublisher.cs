// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Json;
using Ros2Gateway.Messages;
using Ros2Gateway.Messages.BuiltinInterfaces;
using Ros2Gateway.Messages.SensorMsgs;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// Publishes on any topic while it is enabled: from code, or the message in the Inspector at a rate.
    /// </summary>
    [AddComponentMenu("ROS 2 Gateway/Topic Publisher")]
    public sealed class TopicPublisher : ConnectedBehaviour
    {
        [SerializeField]
        private string _topic = "/chatter";

        [SerializeField]
        [Tooltip("pkg/msg/Name, or the number of a message type")]
        private string _type = "std_msgs/msg/String";

        [SerializeField]
        [Tooltip("Late subscribers get the last message. Use it for states, never for commands")]
        private bool _latch;

        [SerializeField]
        [Tooltip("How many messages may wait for the network, before the oldest is dropped. 1: the newest. 0: the "
            + "newest of textures, else 10")]
        [Range(0, 100)]
        private int _queue;

        [SerializeField]
        private QosSettings _qos = new QosSettings();

        [SerializeField]
        [Tooltip("How often the message below is published, in Hz. 0 for never. Textures: at most this often, "
            + "0 for no limit")]
        [Range(0, 100)]
        private float _rate;

        [SerializeField]
        [Tooltip("A message as JSON, such as {\"data\":\"hello\"}. Missing fields have their defaults")]
        [TextArea(2, 10)]
        private string _message = "";

        [SerializeReference]
        [Tooltip("The message field by field, instead of JSON. Stamps of 0 are set when it is published")]
        private IMessage _fields;

        [SerializeField]
        [Tooltip("Of textures: quality of the JPEG")]
        [Range(1, 100)]
        private int _imageQuality = 75;

        [SerializeField]
        [Tooltip("Of textures: scaled down to fit, in pixels. 0 for no limit")]
        [Range(0, 4096)]
        private int _imageMaxWidth = 640;

        [SerializeField]
        [Tooltip("Of textures: scaled down to fit, in pixels. 0 for no limit")]
        [Range(0, 4096)]
        private int _imageMaxHeight;

        private readonly TextureEncoder _encoder = new TextureEncoder();
        private readonly TextureReadback _readback = new TextureReadback();
        private Publisher _publisher;
        private string _fullType;
        private DynamicMessage _parsed;
        private string _parsedFrom;
        private float _next;
        private bool _isFailureTold;

        /// <summary>The topic. A change takes effect when the component is enabled the next time.</summary>
        public string Topic
        {
            get { return _topic; }
            set { _topic = value; }
        }

        /// <summary>pkg/msg/Name, or a number of the list of message types. Like <see cref="Topic"/>.</summary>
        public string Type
        {
            get { return _type; }
            set { _type = value; }
        }

        /// <summary>How often <see cref="Message"/> is published, in Hz. 0 for never.</summary>
        public float Rate
        {
            get { return _rate; }
            set { _rate = value; }
        }

        /// <summary>The message that is published at <see cref="Rate"/>, as JSON.</summary>
        public string Message
        {
            get { return _message; }
            set { _message = value; }
        }

        /// <summary>
        /// The message that is published at <see cref="Rate"/> instead of <see cref="Message"/>, unless it is null. Headers
        /// with a stamp of 0 get the time at which it is published.
        /// </summary>
        public IMessage Fields
        {
            get { return _fields; }
            set { _fields = value; }
        }

        /// <summary>Of textures: quality of the JPEG, 1 to 100.</summary>
        public int ImageQuality
        {
            get { return _imageQuality; }
            set { _imageQuality = value; }
        }

        /// <summary>Textures are scaled down to fit, in pixels. 0 for no bound.</summary>
        public int ImageMaxWidth
        {
            get { return _imageMaxWidth; }
            set { _imageMaxWidth = value; }
        }

        /// <summary>Textures are scaled down to fit, in pixels. 0 for no bound.</summary>
        public int ImageMaxHeight
        {
            get { return _imageMaxHeight; }
            set { _imageMaxHeight = value; }
        }

        /// <summary>
        /// How many messages were dropped here before they had left, pictures that the GPU did not give back among them.
        /// </summary>
        public long Dropped
        {
            get { return _publisher == null ? 0 : _publisher.Dropped; }
        }

        /// <summary>Publishes a message. False, and an event says why, if it does not go.</summary>
        public bool Publish(IMessage message)
        {
            return _publisher != null && _publisher.Publish(message);
        }

        /// <summary>
        /// Publishes a message that is written as JSON. False, and the console says why, if it is not a message.
        /// </summary>
        public bool PublishJson(string json)
        {
            DynamicMessage message = Parse(json);
            return message != null && Publish(message);
        }

        /// <summary>
        /// Publishes a picture as JPEG, if <see cref="Rate"/> allows it now. The type must be
        /// sensor_msgs/msg/CompressedImage. If the GPU can be read without waiting for it, the image follows
        /// some frames later, with the time of this call, and is encoded on another thread. A call until then
        /// returns false. Elsewhere (WebGL, OpenGL ES of old phones), and once five pictures in a row could not be read
        /// so, this waits for the GPU, and encodes.
        /// </summary>
        /// <returns>Whether the picture was published, or is under way.</returns>
        public bool PublishTexture(Texture texture, string frameId = "")
        {
            float now = Time.unscaledTime;
            if (now < _next || _publisher == null || !Connection.Client.IsConnected)
            {
                return false;
            }
            if (_fullType != CompressedImageMsg.Type)
            {
                return Publish(new CompressedImageMsg()); // which is refused in words, before any encoding
            }
            if (!TextureEncoder.HasPixels(texture) || _readback.IsBusy)
            {
                return false;
            }
            _next = now + (_rate > 0 ? 1 / _rate : 0);
            CompressedImageMsg picture = new CompressedImageMsg { format = "jpeg" };
            picture.header.frame_id = frameId;
            Stamp(picture.header.stamp);
            if (!TextureReadback.IsSupported || _readback.HasFailed)
            {
                picture.data = _encoder.Encode(texture, _imageMaxWidth, _imageMaxHeight, _imageQuality);
                return Publish(picture);
            }
            int width;
            int height;
            TextureEncoder.Fit(texture, _imageMaxWidth, _imageMaxHeight, out width, out height);
            Publisher publisher = _publisher; // that of now: the component may be disabled and enabled in the meantime
            _readback.Begin(texture, width, height, _imageQuality, jpeg =>
            {
                if (publisher.IsDisposed)
                {
                    return;
                }
                if (jpeg == null)
                {
                    publisher.Drop();
                    WarnOfReadback();
                    return;
                }
                picture.data = jpeg;
                publisher.Publish(picture);
            });
            return true;
        }

        /// <summary>Whether <see cref="PublishTexture"/> would take a picture now.</summary>
        internal bool IsTextureDue
        {
            get
            {
                return Time.unscaledTime >= _next && _publisher != null && Connection.Client.IsConnected && !_readback.IsBusy
                    && _fullType == CompressedImageMsg.Type;
            }
        }

        /// <inheritdoc/>
        protected internal override bool MovesRobots
        {
            get { return true; } // by commands, if that is the topic
        }

        /// <inheritdoc/>
        protected override void Bind(GatewayConnection connection)
        {
            _readback.Retry();
            _fullType = MessageCatalogue.Resolve(_type) ?? _type;
            _parsedFrom = null; // it may be of another type now
            AdvertiseOptions options = new AdvertiseOptions
            {
                Queue = _queue > 0 ? _queue : QueueDefault.Beside(this, AdvertiseOptions.DefaultQueue),
                Latch = _latch,
                Qos = _qos.Options(),
            };
            _publisher = connection.Client.Advertise(_topic, _fullType, options);
        }

        private void Update()
        {
            bool isEmpty = _fields == null && string.IsNullOrEmpty(_message);
            if (_rate <= 0 || isEmpty || Time.unscaledTime < _next)
            {
                return;
            }
            _next = Time.unscaledTime + 1 / _rate;
            DynamicMessage message = _fields != null ? UnstampedMessage.Of(_fields) : Parsed();
            if (message != null && _publisher != null && Connection.Client.IsConnected)
            {
                Publish(message);
            }
        }

        /// <inheritdoc/>
        protected override void Unbind(GatewayConnection connection)
        {
            if (_publisher != null)
            {
                _publisher.Dispose();
                _publisher = null;
            }
        }

        private void OnDestroy()
        {
            _encoder.Destroy();
            _readback.Destroy();
        }

        private void WarnOfReadback()
        {
            if (!_isFailureTold || _readback.HasFailed)
            {
                _isFailureTold = true;
                Debug.LogWarning(
                    "Topic Publisher of " + _topic + ": the GPU did not return an image, which is dropped"
                    + (_readback.HasFailed ? ", as several before: from now on the main thread waits for the GPU" : ""), this);
            }
        }

        private DynamicMessage Parsed()
        {
            if (_parsedFrom != _message)
            {
                _parsedFrom = _message;
                _parsed = Parse(_message);
            }
            return _parsed;
        }

        private DynamicMessage Parse(string json)
        {
            try
            {
                return new DynamicMessage(_fullType) { Value = JsonValue.Parse(json ?? "") };
            }
            catch (JsonFormatException error)
            {
                Debug.LogError("Topic Publisher of " + _topic + ": " + error.Message, this);
                return null;
            }
        }

        /// <summary>ROS time, as far as the connection knows it.</summary>
        private void Stamp(TimeMsg stamp)
        {
            double now = Connection.Client.RosClock.RosSeconds;
            if (!double.IsNaN(now))
            {
                double seconds = System.Math.Floor(now);
                stamp.sec = (int)seconds;
                stamp.nanosec = (uint)((now - seconds) * 1e9);
            }
        }
    }
}
