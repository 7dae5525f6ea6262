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
    public sealed class TopicPublisher : MonoBehaviour
    {
        [SerializeField]
        [Tooltip("Without, the scene's")]
        private GatewayConnection _connection;

        [SerializeField]
        private string _topic = "/chatter";

        [SerializeField]
        [Tooltip("pkg/msg/Name, or a number of the message table")]
        private string _type = "std_msgs/msg/String";

        [SerializeField]
        [Tooltip("Late subscribers get the last message. For what is a state, never for commands")]
        private bool _latch;

        [SerializeField]
        [Tooltip("How many messages may wait for the network, the oldest being dropped")]
        [Range(1, 100)]
        private int _queue = 2;

        [SerializeField]
        private QosSettings _qos = new QosSettings();

        [SerializeField]
        [Tooltip("How often the message below is published, in Hz; 0 for never. Textures: at most so often, "
            + "0 for no limit")]
        [Range(0, 100)]
        private float _rate;

        [SerializeField]
        [Tooltip("A message as JSON, such as {\"data\":\"hello\"}; fields left out have their defaults")]
        [TextArea(2, 10)]
        private string _message = "";

        [SerializeField]
        [Tooltip("Of textures: quality of the JPEG")]
        [Range(1, 100)]
        private int _imageQuality = 75;

        [SerializeField]
        [Tooltip("Of textures: scaled down to fit, in pixels; 0 for no bound")]
        [Range(0, 4096)]
        private int _imageMaxWidth = 640;

        [SerializeField]
        [Tooltip("Of textures: scaled down to fit, in pixels; 0 for no bound")]
        [Range(0, 4096)]
        private int _imageMaxHeight;

        private readonly TextureEncoder _encoder = new TextureEncoder();
        private Publisher _publisher;
        private string _fullType;
        private DynamicMessage _parsed;
        private string _parsedFrom;
        private float _next;

        /// <summary>The topic; a change takes effect when the component is enabled the next time.</summary>
        public string Topic
        {
            get { return _topic; }
            set { _topic = value; }
        }

        /// <summary>pkg/msg/Name, or a number of the message table; like <see cref="Topic"/>.</summary>
        public string Type
        {
            get { return _type; }
            set { _type = value; }
        }

        /// <summary>How often <see cref="Message"/> is published, in Hz; 0 for never.</summary>
        public float Rate
        {
            get { return _rate; }
            set { _rate = value; }
        }

        /// <summary>What is published at <see cref="Rate"/>: a message as JSON.</summary>
        public string Message
        {
            get { return _message; }
            set { _message = value; }
        }

        /// <summary>Of textures: quality of the JPEG, 1 to 100.</summary>
        public int ImageQuality
        {
            get { return _imageQuality; }
            set { _imageQuality = value; }
        }

        /// <summary>Textures are scaled down to fit, in pixels; 0 for no bound.</summary>
        public int ImageMaxWidth
        {
            get { return _imageMaxWidth; }
            set { _imageMaxWidth = value; }
        }

        /// <summary>Textures are scaled down to fit, in pixels; 0 for no bound.</summary>
        public int ImageMaxHeight
        {
            get { return _imageMaxHeight; }
            set { _imageMaxHeight = value; }
        }

        /// <summary>Whose publisher this is; like <see cref="Topic"/>.</summary>
        public GatewayConnection Connection
        {
            get { return _connection; }
            set { _connection = value; }
        }

        /// <summary>Publishes a message; false, and an event says why, if it does not go.</summary>
        public bool Publish(IMessage message)
        {
            return _publisher != null && _publisher.Publish(message);
        }

        /// <summary>
        /// Publishes a message that is written as JSON; false, and the console says why, if it is none.
        /// </summary>
        public bool PublishJson(string json)
        {
            DynamicMessage message = Parse(json);
            return message != null && Publish(message);
        }

        /// <summary>
        /// Publishes a picture as JPEG, if <see cref="Rate"/> allows it now; the type must be
        /// sensor_msgs/msg/CompressedImage. Encoding takes a few milliseconds of the main thread.
        /// </summary>
        public bool PublishTexture(Texture texture, string frameId = "")
        {
            float now = Time.unscaledTime;
            if (now < _next || _publisher == null || _connection == null || !_connection.Client.IsConnected)
            {
                return false;
            }
            if (_fullType != CompressedImageMsg.Type)
            {
                return Publish(new CompressedImageMsg()); // which is refused in words, before any encoding
            }
            byte[] jpeg = _encoder.Encode(texture, _imageMaxWidth, _imageMaxHeight, _imageQuality);
            if (jpeg == null)
            {
                return false;
            }
            _next = now + (_rate > 0 ? 1 / _rate : 0);
            CompressedImageMsg picture = new CompressedImageMsg { format = "jpeg", data = jpeg };
            picture.header.frame_id = frameId;
            Stamp(picture.header.stamp);
            return Publish(picture);
        }

        private void OnEnable()
        {
            _connection = GatewayConnection.For(this, _connection);
            if (_connection == null)
            {
                return;
            }
            IMessage example = MessageCatalogue.Create(_type);
            _fullType = example == null ? _type : example.RosType;
            _parsedFrom = null; // it may be of another type now
            AdvertiseOptions options = new AdvertiseOptions
            {
                Queue = _queue,
                Latch = _latch,
                Qos = _qos.Options(),
            };
            _publisher = _connection.Client.Advertise(_topic, _fullType, options);
        }

        private void Update()
        {
            if (_rate <= 0 || string.IsNullOrEmpty(_message) || Time.unscaledTime < _next)
            {
                return;
            }
            _next = Time.unscaledTime + 1 / _rate;
            if (_parsedFrom != _message)
            {
                _parsedFrom = _message;
                _parsed = Parse(_message);
            }
            if (_parsed != null && _connection != null && _connection.Client.IsConnected)
            {
                Publish(_parsed);
            }
        }

        private void OnDisable()
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
            double now = _connection.Client.RosClock.RosSeconds;
            if (!double.IsNaN(now))
            {
                double seconds = System.Math.Floor(now);
                stamp.sec = (int)seconds;
                stamp.nanosec = (uint)((now - seconds) * 1e9);
            }
        }
    }
}
