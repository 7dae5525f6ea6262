// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Json;
using Ros2Gateway.Messages;
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
        private QosSettings _qos = new();

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

        private Publisher _publisher;
        private string _fullType;
        private DynamicMessage _parsed;
        private string _parsedFrom;
        private float _next;

        /// <summary>The topic. A change takes effect when the component is enabled the next time.</summary>
        public string Topic
        {
            get => _topic;
            set => _topic = value;
        }

        /// <summary>pkg/msg/Name, or a number of the list of message types. Like <see cref="Topic"/>.</summary>
        public string Type
        {
            get => _type;
            set => _type = value;
        }

        /// <summary>How often <see cref="Message"/> is published, in Hz. 0 for never.</summary>
        public float Rate
        {
            get => _rate;
            set => _rate = value;
        }

        /// <summary>The message that is published at <see cref="Rate"/>, as JSON.</summary>
        public string Message
        {
            get => _message;
            set => _message = value;
        }

        /// <summary>
        /// The message that is published at <see cref="Rate"/> instead of <see cref="Message"/>, unless it is null. Headers
        /// with a stamp of 0 get the time at which it is published.
        /// </summary>
        public IMessage Fields
        {
            get => _fields;
            set => _fields = value;
        }

        /// <summary>Of textures: quality of the JPEG, 1 to 100.</summary>
        public int ImageQuality
        {
            get => _imageQuality;
            set => _imageQuality = value;
        }

        /// <summary>Textures are scaled down to fit, in pixels. 0 for no bound.</summary>
        public int ImageMaxWidth
        {
            get => _imageMaxWidth;
            set => _imageMaxWidth = value;
        }

        /// <summary>Textures are scaled down to fit, in pixels. 0 for no bound.</summary>
        public int ImageMaxHeight
        {
            get => _imageMaxHeight;
            set => _imageMaxHeight = value;
        }

        /// <summary>
        /// How many messages were dropped here before they had left, pictures that the GPU did not give back among them.
        /// </summary>
        public long Dropped => _publisher == null ? 0 : _publisher.Dropped;

        /// <summary>What publishes now. Null while there is no connection.</summary>
        internal Publisher Publisher => _publisher;

        /// <summary>Publishes a message. False, and an event says why, if it does not go.</summary>
        public bool Publish(IMessage message) => _publisher != null && _publisher.Publish(message);

        /// <summary>
        /// Publishes a message that is written as JSON. False, and the console says why, if it is not a message.
        /// </summary>
        public bool PublishJson(string json)
        {
            DynamicMessage message = Parse(json);
            return message != null && Publish(message);
        }

        /// <inheritdoc/>
        protected internal override bool MovesRobots => true; // by commands, if that is the topic

        /// <inheritdoc/>
        protected override void Bind(GatewayConnection connection)
        {
            _fullType = MessageCatalogue.Resolve(_type) ?? _type;
            _parsedFrom = null; // it may be of another type now
            AdvertiseOptions options = new()
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
            _publisher?.Dispose();
            _publisher = null;
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
    }
}
