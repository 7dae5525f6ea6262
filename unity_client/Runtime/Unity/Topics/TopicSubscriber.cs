// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Messages;
using Ros2Gateway.Messages.SensorMsgs;
using UnityEngine;
using UnityEngine.Events;

namespace Ros2Gateway.Unity
{
    /// <summary>A message, for the Inspector's lists of what to call.</summary>
    [Serializable]
    public sealed class MessageEvent : UnityEvent<IMessage>
    {
    }

    /// <summary>Subscribes to any topic while it is enabled; displays beside it show what comes.</summary>
    [AddComponentMenu("ROS 2 Gateway/Topic Subscriber")]
    public sealed class TopicSubscriber : MonoBehaviour
    {
        private const string ImageType = "sensor_msgs/msg/Image";
        private const float RateSeconds = 1; // over how long the rate is counted

        [SerializeField]
        [Tooltip("Without, the scene's")]
        private GatewayConnection _connection;

        [SerializeField]
        private string _topic = "/odom";

        [SerializeField]
        [Tooltip("pkg/msg/Name or a number of the message table; empty to take what the topic has, as a tree")]
        private string _type = "";

        [SerializeField]
        [Tooltip("How many messages may wait, the oldest being dropped; 1 is always the newest")]
        [Range(1, 1000)]
        private int _queue = 1;

        [SerializeField]
        [Tooltip("At most so many messages a second, the newest; 0 for all")]
        [Range(0, 200)]
        private float _maxRate;

        [SerializeField]
        [Tooltip("Only these fields, as dotted paths such as pose.pose.position; empty for all")]
        private string[] _fields = new string[0];

        [SerializeField]
        private QosSettings _qos = new QosSettings();

        [SerializeField]
        [Tooltip("Of pictures: quality of the JPEG")]
        [Range(1, 100)]
        private int _imageQuality = 80;

        [SerializeField]
        [Tooltip("Of pictures: lower quality, and fewer pixels, while the link is too slow")]
        private bool _imageAdapts = true;

        [SerializeField]
        [Tooltip("Of pictures: scaled down to fit, in pixels; 0 for no bound")]
        private int _imageMaxWidth;

        [SerializeField]
        [Tooltip("Of pictures: scaled down to fit, in pixels; 0 for no bound")]
        private int _imageMaxHeight;

        [SerializeField]
        private MessageEvent _onMessage = new MessageEvent();

        private Subscription<IMessage> _subscription;
        private float _rateSince;
        private int _rateCount;

        /// <summary>A message has come; called in Update.</summary>
        public event Action<IMessage> MessageReceived;

        /// <summary>The topic; a change takes effect when the component is enabled the next time.</summary>
        public string Topic
        {
            get { return _topic; }
            set { _topic = value; }
        }

        /// <summary>pkg/msg/Name, a number of the message table, or empty; like <see cref="Topic"/>.</summary>
        public string Type
        {
            get { return _type; }
            set { _type = value; }
        }

        /// <summary>At most so many messages a second; 0 for all; like <see cref="Topic"/>.</summary>
        public float MaxRate
        {
            get { return _maxRate; }
            set { _maxRate = value; }
        }

        /// <summary>Whose messages these are; like <see cref="Topic"/>.</summary>
        public GatewayConnection Connection
        {
            get { return _connection; }
            set { _connection = value; }
        }

        /// <summary>What the Inspector's list calls.</summary>
        public MessageEvent OnMessage
        {
            get { return _onMessage; }
        }

        /// <summary>The newest message; null before the first.</summary>
        public IMessage Last { get; private set; }

        /// <summary>When it came, as Time.unscaledTime; negative before the first.</summary>
        public float LastTime { get; private set; }

        /// <summary>How many messages came in the last second.</summary>
        public float RateHz { get; private set; }

        /// <summary>How many messages made room for newer ones here.</summary>
        public long Dropped
        {
            get { return _subscription == null ? 0 : _subscription.Dropped; }
        }

        private void OnEnable()
        {
            LastTime = -1;
            _connection = GatewayConnection.For(this, _connection);
            if (_connection == null)
            {
                return;
            }
            SubscribeOptions options = new SubscribeOptions
            {
                Queue = _queue,
                ThrottleMilliseconds = _maxRate > 0 ? 1000 / _maxRate : 0,
                Fields = _fields.Length > 0 ? _fields : null,
                Qos = _qos.Options(),
            };
            IMessage example = string.IsNullOrEmpty(_type) ? null : MessageCatalogue.Create(_type);
            string type = example == null ? _type : example.RosType;
            Func<IMessage> create = () => new DynamicMessage(type);
            if (type == ImageType && _fields.Length == 0)
            {
                options.Image = new ImageOptions
                {
                    Format = "jpeg",
                    Quality = _imageQuality,
                    Adapt = _imageAdapts,
                    MaxWidth = _imageMaxWidth,
                    MaxHeight = _imageMaxHeight,
                    MaxFps = _maxRate,
                };
                create = () => new CompressedImageMsg(); // what the gateway makes of an Image
            }
            else if (example != null)
            {
                create = () => MessageCatalogue.Create(type);
            }
            _subscription = _connection.Client.Subscribe(_topic, type, create, Receive, options);
        }

        private void Update()
        {
            float now = Time.unscaledTime;
            if (now - _rateSince >= RateSeconds)
            {
                RateHz = _rateCount / (now - _rateSince);
                _rateSince = now;
                _rateCount = 0;
            }
        }

        private void OnDisable()
        {
            if (_subscription != null)
            {
                _subscription.Dispose();
                _subscription = null;
            }
        }

        private void Receive(IMessage message)
        {
            Last = message;
            LastTime = Time.unscaledTime;
            _rateCount++;
            if (MessageReceived != null)
            {
                MessageReceived(message);
            }
            _onMessage.Invoke(message);
        }
    }
}
