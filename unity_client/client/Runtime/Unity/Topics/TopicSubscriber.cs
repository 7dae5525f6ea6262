// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Messages;
using Ros2Gateway.Messages.SensorMsgs;
using Ros2Gateway.Pictures;
using UnityEngine;
using UnityEngine.Events;

namespace Ros2Gateway.Unity
{
    /// <summary>A message, for the Inspector's lists of what to call.</summary>
    [Serializable]
    public sealed class MessageEvent : UnityEvent<IMessage>
    {
    }

    /// <summary>Subscribes to any topic while it is enabled. Displays next to it show what comes.</summary>
    [AddComponentMenu("ROS 2 Gateway/Topic Subscriber")]
    public sealed class TopicSubscriber : ConnectedBehaviour
    {
        private const string ImageType = "sensor_msgs/msg/Image";
        private const float RateSeconds = 1; // over how long the rate is counted

        [SerializeField]
        private string _topic = "/odom";

        [SerializeField]
        [Tooltip("pkg/msg/Name, or the number of a message type. Empty: the type of the topic, as a tree")]
        private string _type = "";

        [SerializeField]
        [Tooltip("How many messages may wait, before the oldest is dropped. 1: the newest. 0: the newest if "
            + "displays on this object show only the newest, else 10")]
        [Range(0, 1000)]
        private int _queue;

        [SerializeField]
        [Tooltip("At most this many messages per second, the newest. 0 for all")]
        [Range(0, 200)]
        private float _maxRate;

        [SerializeField]
        [Tooltip("Only these fields, as dotted paths such as pose.pose.position. Empty for all")]
        private string[] _fields = new string[0];

        [SerializeField]
        [Tooltip("Fill the same messages again instead of making new ones: use each only until the next one arrives")]
        private bool _reuse;

        [SerializeField]
        private QosSettings _qos = new();

        [SerializeField]
        [Tooltip("Of images: jpeg, or png for exact values, such as depth")]
        private string _imageFormat = "jpeg";

        [SerializeField]
        [Tooltip("Of images: quality of the JPEG")]
        [Range(1, 100)]
        private int _imageQuality = 80;

        [SerializeField]
        [Tooltip("Of images: lower quality and fewer pixels while the network is too slow")]
        private bool _imageAdapts = true;

        [SerializeField]
        [Tooltip("Of images: scaled down to fit, in pixels. 0 for no limit")]
        private int _imageMaxWidth;

        [SerializeField]
        [Tooltip("Of images: scaled down to fit, in pixels. 0 for no limit")]
        private int _imageMaxHeight;

        [SerializeField]
        private MessageEvent _onMessage = new();

        private readonly Listeners<IMessage> _messageReceived;
        private readonly Listeners<IMessage> _messageArriving;
        private volatile FaultReport _arrivalFault;
        private Subscription<IMessage> _subscription;
        private bool _isPicture; // an Image, of which the gateway makes one
        private int _shownSide;
        private float _rateSince;
        private int _rateCount;

        /// <summary>A component of the scene. Made by Unity.</summary>
        public TopicSubscriber()
        {
            _messageReceived = new Listeners<IMessage>(ReportFault, "listener of MessageReceived");
            _messageReceived.SetLast("listener of On Message", message => _onMessage.Invoke(message));
            _messageArriving = new Listeners<IMessage>(
                (where, error, times) => _arrivalFault(where, error, times), "listener of MessageArriving");
        }

        /// <summary>A message has come. Called in Update.</summary>
        public event Action<IMessage> MessageReceived
        {
            add => _messageReceived.Add(value);
            remove => _messageReceived.Remove(value);
        }

        /// <summary>
        /// A message has come, and waits for <see cref="MessageReceived"/>, unless a newer one takes its place.
        /// Called on the thread that reads frames, where nothing of Unity may be used and all topics wait:
        /// for handing work to other threads early.
        /// </summary>
        public event Action<IMessage> MessageArriving
        {
            add => _messageArriving.Add(value);
            remove => _messageArriving.Remove(value);
        }

        /// <summary>The topic. A change takes effect when the component is enabled the next time.</summary>
        public string Topic
        {
            get => _topic;
            set => _topic = value;
        }

        /// <summary>pkg/msg/Name, a number of the list of message types, or empty. Like <see cref="Topic"/>.</summary>
        public string Type
        {
            get => _type;
            set => _type = value;
        }

        /// <summary>At most so many messages a second. 0 for all. Like <see cref="Topic"/>.</summary>
        public float MaxRate
        {
            get => _maxRate;
            set => _maxRate = value;
        }

        /// <summary>Of pictures: jpeg, or png for what must come exactly, such as depth. Like <see cref="Topic"/>.</summary>
        public string ImageFormat
        {
            get => _imageFormat;
            set => _imageFormat = value;
        }

        /// <summary>
        /// Whether messages are filled again, which spares the garbage collector large ones: each may be used until
        /// the next one comes. The package's displays do not keep them longer. Pictures come as
        /// <see cref="PictureMsg"/> then. Like <see cref="Topic"/>.
        /// </summary>
        public bool Reuse
        {
            get => _reuse;
            set => _reuse = value;
        }

        /// <summary>
        /// How many messages may wait. 0 for the newest where displays next to this show it alone, else 10. Like
        /// <see cref="Topic"/>.
        /// </summary>
        public int Queue
        {
            get => _queue;
            set => _queue = value;
        }

        /// <summary>
        /// The longest side that a picture is shown with, in pixels. 0 for any. Those of sensor_msgs/msg/Image come no
        /// larger, unless as PNG. All others come as they are. A change takes effect at once.
        /// </summary>
        public int ShownSide
        {
            get => _shownSide;

            set
            {
                if (value != _shownSide)
                {
                    _shownSide = value;
                    if (_subscription != null && _isPicture)
                    {
                        _subscription.ChangeImage(Picture());
                    }
                }
            }
        }

        /// <summary>The Inspector's list of calls.</summary>
        public MessageEvent OnMessage => _onMessage;

        /// <summary>The newest message. Null before the first.</summary>
        public IMessage Last { get; private set; }

        /// <summary>When it came, as Time.unscaledTime. Negative before the first.</summary>
        public float LastTime { get; private set; }

        /// <summary>
        /// The newest message of this subscription, for what is enabled later. Null before the first, and where
        /// messages are filled again: the next one may be on its way into it.
        /// </summary>
        internal IMessage Kept => _subscription != null && LastTime >= 0 && !_reuse ? Last : null;

        /// <summary>How many messages came in the last second.</summary>
        public float RateHz { get; private set; }

        /// <summary>How many messages made room for newer ones here.</summary>
        public long Dropped => _subscription == null ? 0 : _subscription.Dropped;

        /// <inheritdoc/>
        protected override void Bind(GatewayConnection connection)
        {
            LastTime = -1; // messages of another connection may be of another robot
            SubscribeOptions options = new()
            {
                Queue = _queue > 0 ? _queue : QueueDefault.Beside(this, SubscribeOptions.DefaultQueue),
                ThrottleMilliseconds = _maxRate > 0 ? 1000 / _maxRate : 0,
                Fields = _fields.Length > 0 ? _fields : null,
                Qos = _qos.Options(),
            };
            string type = MessageCatalogue.Resolve(_type) ?? _type;
            // asked for each message: what shows this type may be enabled, and register it, after this
            Func<IMessage> create = () => MessageCatalogue.Create(type) ?? new DynamicMessage(type);
            _isPicture = type == ImageType && _fields.Length == 0;
            if (_isPicture || type == CompressedImageMsg.Type)
            {
                options.Image = _isPicture ? Picture() : null;
                create = NewPicture(); // the gateway's form of an Image
            }
            if (_fields.Length == 0)
            {
                GetComponent<IAsks>()?.Ask(type, options);
            }
            GatewayClient client = connection.Client;
            string name = FaultLog.Name(this); // on the thread that reads frames Unity tells none
            _arrivalFault = (where, error, times) => client.ReportFault(where + " of " + name, error, times);
            _subscription = client.Subscribe(_topic, type, create, Receive, options, _messageArriving.Call, _reuse);
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

        /// <inheritdoc/>
        protected override void Unbind(GatewayConnection connection)
        {
            _subscription?.Dispose();
            _subscription = null;
        }

        private ImageOptions Picture()
        {
            bool isExact = _imageFormat == "png";
            int side = isExact ? 0 : _shownSide;
            return new ImageOptions
            {
                Format = _imageFormat,
                Quality = isExact ? 0 : _imageQuality,
                Adapt = isExact ? (bool?)null : _imageAdapts,
                MaxWidth = Narrower(_imageMaxWidth, side),
                MaxHeight = Narrower(_imageMaxHeight, side),
                MaxFps = _maxRate,
            };
        }

        private static int Narrower(int bound, int other) =>
            bound > 0 && other > 0 ? Math.Min(bound, other) : Math.Max(bound, other);

        private Func<IMessage> NewPicture() =>
            _reuse ? (Func<IMessage>)(() => new PictureMsg()) : () => new CompressedImageMsg();

        private void Receive(IMessage message)
        {
            Last = message;
            LastTime = Time.unscaledTime;
            _rateCount++;
            _messageReceived.Call(message);
        }
    }
}
