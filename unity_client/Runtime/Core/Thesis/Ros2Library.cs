// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;
using System.Globalization;
using Ros2Gateway.Json;
using Ros2Gateway.Messages;
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Messages.NavMsgs;
using Ros2Gateway.Messages.SensorMsgs;
using Ros2Gateway.Messages.StdMsgs;

namespace Ros2Gateway.Thesis
{
    /// <summary>
    /// The calls of the native ROS2-Unity library of 2021, under its own names, for scenes written for it:
    /// <c>using static Ros2Gateway.Thesis.Ros2Library;</c>. The table of old and new calls says what differs.
    /// </summary>
    /// <remarks>
    /// The library was one per process, and scenes call it as such: this class alone in the package holds
    /// static state. Every call returns at once and none throws; what fails returns false, and
    /// <see cref="poll_debug_message"/> says why. Types are the numbers of the message table. Any thread.
    /// </remarks>
    public static class Ros2Library
    {
        private const int MaxDebugMessages = 100; // what a debug screen shows, and some more

        private const int MaxDepth = 1024; // of a ROS subscription, as the gateway has it

        // What the library handed out pixel by pixel.
        private const string ImageType = "sensor_msgs/msg/Image";

        private static readonly object Gate = new object();
        private static readonly Dictionary<string, Publisher> Publishers = new Dictionary<string, Publisher>();
        private static readonly Dictionary<string, Subscription<IMessage>> Subscribers =
            new Dictionary<string, Subscription<IMessage>>();
        private static readonly Queue<string> DebugMessages = new Queue<string>();
        private static GatewayClient _client;
        private static string _prefix = "";
        private static string _lastDebugMessage; // a poll that fails in every frame is one piece of news

        /// <summary>Where the gateway is; what is set counts from the next <see cref="ros2_init"/> on.</summary>
        public static GatewayOptions Options = new GatewayOptions();

        /// <summary>Begins to connect. Called again it does nothing; true in both cases.</summary>
        /// <param name="prefix">
        /// Was the prefix of the library's three nodes, which the gateway's configuration names now
        /// (<c>ros.node_prefix</c>). Kept for debug messages.
        /// </param>
        public static bool ros2_init(string prefix = "")
        {
            lock (Gate)
            {
                if (_client == null)
                {
                    _prefix = prefix ?? "";
                    _client = new GatewayClient(Options ?? new GatewayOptions());
                    _client.EventHeard += happened => Remember(happened.ToString());
                    _client.Connect();
                }
                return true;
            }
        }

        /// <summary>Whether the gateway is connected: until it is, sending fails.</summary>
        public static bool ros2_ok()
        {
            lock (Gate)
            {
                return Pumped() && _client.IsConnected;
            }
        }

        /// <summary>Ends the connection, and all publishers and subscribers. Called again it does nothing.</summary>
        public static void ros2_shutdown()
        {
            lock (Gate)
            {
                Publishers.Clear();
                Subscribers.Clear();
                if (_client != null)
                {
                    _client.Dispose();
                    _client = null;
                }
            }
        }

        /// <summary>Registers a publisher; a second one on the same topic takes the place of the first.</summary>
        /// <param name="type">The number of the type in the message table.</param>
        /// <param name="backlog">How many messages may wait, the oldest being dropped.</param>
        public static bool add_publisher(string topic, int type, int backlog)
        {
            lock (Gate)
            {
                IMessage example = Example("add_publisher", topic, type);
                if (example == null)
                {
                    return false;
                }
                Publisher former;
                if (Publishers.TryGetValue(topic, out former))
                {
                    former.Dispose();
                }
                Publishers[topic] = _client.Advertise(
                    topic, example.RosType, new AdvertiseOptions { Queue = backlog });
                return true;
            }
        }

        /// <summary>Registers a subscriber; a second one on the same topic takes the place of the first.</summary>
        /// <param name="type">The number of the type in the message table.</param>
        /// <param name="libraryBacklog">How many messages wait here to be polled, the oldest being dropped.</param>
        /// <param name="rosBacklog">The depth of the ROS subscription.</param>
        public static bool add_subscriber(string topic, int type, int libraryBacklog, int rosBacklog)
        {
            lock (Gate)
            {
                IMessage example = Example("add_subscriber", topic, type);
                if (example == null)
                {
                    return false;
                }
                Subscription<IMessage> former;
                if (Subscribers.TryGetValue(topic, out former))
                {
                    former.Dispose();
                }
                SubscribeOptions options = new SubscribeOptions
                {
                    Queue = libraryBacklog,
                    Qos = rosBacklog > 0 ? new QosOptions { Depth = System.Math.Min(rosBacklog, MaxDepth) } : null,
                    Image = example.RosType == ImageType ? new ImageOptions { Format = "raw" } : null,
                };
                string name = example.RosType;
                Subscribers[topic] = _client.Subscribe<IMessage>(
                    topic, name, () => MessageCatalogue.Create(name), null, options);
                return true;
            }
        }

        /// <summary>Sends a text.</summary>
        public static bool send_string(string topic, string text)
        {
            return send(topic, new StringMsg { data = text });
        }

        /// <summary>Sends a velocity: metres and radians per second, in ROS coordinates.</summary>
        public static bool send_twist(
            string topic, double linearX, double linearY, double linearZ,
            double angularX, double angularY, double angularZ)
        {
            TwistMsg twist = new TwistMsg();
            twist.linear.x = linearX;
            twist.linear.y = linearY;
            twist.linear.z = linearZ;
            twist.angular.x = angularX;
            twist.angular.y = angularY;
            twist.angular.z = angularZ;
            return send(topic, twist);
        }

        /// <summary>Sends a velocity.</summary>
        public static bool send_twist(string topic, TwistMsg twist)
        {
            return send(topic, twist);
        }

        /// <summary>Sends a header; with a stamp of 0 it gets the time at which it arrives.</summary>
        public static bool send_header(string topic, HeaderMsg header)
        {
            return send(topic, header);
        }

        /// <summary>Sends a pose in a frame.</summary>
        public static bool send_pose(string topic, PoseStampedMsg pose)
        {
            return send(topic, pose);
        }

        /// <summary>Sends a pose with its covariance.</summary>
        public static bool send_pose_with_cov(string topic, PoseWithCovarianceStampedMsg pose)
        {
            return send(topic, pose);
        }

        /// <summary>Sends a message of whatever type the publisher has.</summary>
        public static bool send(string topic, IMessage message)
        {
            lock (Gate)
            {
                if (!Pumped())
                {
                    return Failed("send", topic, "ros2_init comes first");
                }
                Publisher publisher;
                if (!Publishers.TryGetValue(topic ?? "", out publisher))
                {
                    return Failed("send", topic, "no publisher; add_publisher comes first");
                }
                return message != null
                    ? publisher.Publish(message)
                    : Failed("send", topic, "no message");
            }
        }

        /// <summary>Takes the oldest unread text.</summary>
        public static bool poll_string(string topic, out string text)
        {
            StringMsg message;
            bool isThere = poll(topic, out message);
            text = isThere ? message.data : "";
            return isThere;
        }

        /// <summary>Takes the oldest unread velocity.</summary>
        public static bool poll_twist(string topic, out TwistMsg twist)
        {
            return poll(topic, out twist);
        }

        /// <summary>Takes the oldest unread header.</summary>
        public static bool poll_header(string topic, out HeaderMsg header)
        {
            return poll(topic, out header);
        }

        /// <summary>Takes the oldest unread picture, as pixels.</summary>
        public static bool poll_image(string topic, out ImageMsg image)
        {
            return poll(topic, out image);
        }

        /// <summary>Takes the oldest unread picture, as JPEG or PNG.</summary>
        public static bool poll_compressed_image(string topic, out CompressedImageMsg image)
        {
            return poll(topic, out image);
        }

        /// <summary>Takes the oldest unread state of the battery.</summary>
        public static bool poll_battery_state(string topic, out BatteryStateMsg state)
        {
            return poll(topic, out state);
        }

        /// <summary>Takes the oldest unread laser scan.</summary>
        public static bool poll_laser_scan(string topic, out LaserScanMsg scan)
        {
            return poll(topic, out scan);
        }

        /// <summary>Takes the oldest unread odometry.</summary>
        /// <param name="withCovariances">Without, both covariances are null.</param>
        public static bool poll_odometry(string topic, out OdometryMsg odometry, bool withCovariances = true)
        {
            bool isThere = poll(topic, out odometry);
            if (isThere && !withCovariances)
            {
                odometry.pose.covariance = null;
                odometry.twist.covariance = null;
            }
            return isThere;
        }

        /// <summary>Takes the oldest unread message of whatever type the subscriber has.</summary>
        /// <returns>False if there is none, no subscriber, or one of another type.</returns>
        public static bool poll<T>(string topic, out T message)
            where T : class, IMessage
        {
            message = null;
            lock (Gate)
            {
                if (!Pumped())
                {
                    return Failed("poll", topic, "ros2_init comes first");
                }
                Subscription<IMessage> subscriber;
                if (!Subscribers.TryGetValue(topic ?? "", out subscriber))
                {
                    return Failed("poll", topic, "no subscriber; add_subscriber comes first");
                }
                IMessage taken;
                if (!subscriber.TryTake(out taken))
                {
                    return false;
                }
                message = taken as T;
                return message != null || Failed("poll", topic, "the subscriber has type " + subscriber.Type);
            }
        }

        /// <summary>Takes the oldest unread word on what happened: refusals, faults, the connection.</summary>
        public static bool poll_debug_message(out string text)
        {
            lock (Gate)
            {
                Pumped();
                text = DebugMessages.Count > 0 ? DebugMessages.Dequeue() : "";
                return text.Length > 0;
            }
        }

        private static bool Pumped()
        {
            if (_client == null)
            {
                return false;
            }
            _client.Pump(0);
            return true;
        }

        private static IMessage Example(string call, string topic, int type)
        {
            if (!Pumped())
            {
                Failed(call, topic, "ros2_init comes first");
                return null;
            }
            if (string.IsNullOrEmpty(topic))
            {
                Failed(call, "", "a topic is missing");
                return null;
            }
            IMessage example = MessageCatalogue.Create(type.ToString(CultureInfo.InvariantCulture));
            if (example == null)
            {
                Failed(call, topic, "the message table has no number " + type);
            }
            return example;
        }

        private static bool Failed(string call, string topic, string words)
        {
            Remember(call + " " + topic + ": " + words);
            return false;
        }

        private static void Remember(string text)
        {
            if (text == _lastDebugMessage)
            {
                return;
            }
            _lastDebugMessage = text;
            if (DebugMessages.Count >= MaxDebugMessages)
            {
                DebugMessages.Dequeue();
            }
            DebugMessages.Enqueue(_prefix.Length == 0 ? text : _prefix + ": " + text);
        }
    }
}
