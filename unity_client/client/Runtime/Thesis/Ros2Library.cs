// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Globalization;
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
    /// static state. Every call returns at once and none throws. A call that fails returns false, and
    /// <see cref="poll_debug_message"/> says why. Types are the numbers of the list of message types. Any thread.
    /// </remarks>
    public static partial class Ros2Library
    {
        private const int MaxDebugMessages = 100; // more than a debug screen shows

        private const int MaxDepth = 1024; // of a ROS subscription, as the gateway has it

        // The library handed these out pixel by pixel.
        private const string ImageType = "sensor_msgs/msg/Image";

        private static readonly object Gate = new();
        private static readonly Dictionary<string, Publisher> Publishers = new();
        private static readonly Dictionary<string, Subscription<IMessage>> Subscribers = new();
        private static readonly Queue<string> DebugMessages = new();
        private static GatewayClient _client;
        private static string _prefix = "";
        private static string _lastDebugMessage; // a poll that fails in every frame is one piece of news

        /// <summary>The address of the gateway. A change counts from the next <see cref="ros2_init"/> on.</summary>
        public static GatewayOptions Options = new();

        /// <summary>Begins to connect. Called again it does nothing. True in both cases.</summary>
        /// <param name="prefix">
        /// The start of the names of the nodes. They are the gateway's, which takes it as <c>--node-prefix</c>.
        /// A debug message tells if it has another one. Debug messages begin with it as well.
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
                    if (_prefix.Length > 0)
                    {
                        _client.WatchGraph(CompareNodes);
                    }
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
                _client?.Dispose();
                _client = null;
            }
        }

        /// <summary>Registers a publisher. False where the topic has one, which stays.</summary>
        /// <param name="type">The number of the type in the list of message types.</param>
        /// <param name="backlog">How many messages may wait, the oldest being dropped.</param>
        public static bool add_publisher(string topic, uint type, uint backlog)
        {
            lock (Gate)
            {
                IMessage example = Example("add_publisher", topic, type);
                if (example == null)
                {
                    return false;
                }
                if (Publishers.ContainsKey(topic))
                {
                    return Failed("add_publisher", topic, "the topic has a publisher already");
                }
                Publishers[topic] = _client.Advertise(
                    topic, example.RosType, new AdvertiseOptions { Queue = Signed(backlog) });
                return true;
            }
        }

        /// <inheritdoc cref="add_publisher(string, uint, uint)"/>
        public static bool add_publisher(string topic, int type, int backlog) =>
            add_publisher(topic, Number(type), Unsigned(backlog));

        /// <summary>Registers a subscriber. A second one on the same topic takes the place of the first.</summary>
        /// <param name="type">The number of the type in the list of message types.</param>
        /// <param name="libraryBacklog">How many messages wait here to be polled, the oldest being dropped.</param>
        /// <param name="rosBacklog">The depth of the ROS subscription.</param>
        public static bool add_subscriber(string topic, uint type, uint libraryBacklog, uint rosBacklog)
        {
            lock (Gate)
            {
                IMessage example = Example("add_subscriber", topic, type);
                if (example == null)
                {
                    return false;
                }
                if (Subscribers.TryGetValue(topic, out Subscription<IMessage> former))
                {
                    former.Dispose();
                }
                SubscribeOptions options = new()
                {
                    Queue = Signed(libraryBacklog),
                    KeepsBursts = false,
                    Qos = rosBacklog > 0 ? new QosOptions { Depth = (int)Math.Min(rosBacklog, MaxDepth) } : null,
                    Image = example.RosType == ImageType ? new ImageOptions { Format = "raw" } : null,
                };
                string name = example.RosType;
                Subscribers[topic] = _client.Subscribe<IMessage>(
                    topic, name, () => MessageCatalogue.Create(name), null, options);
                return true;
            }
        }

        /// <inheritdoc cref="add_subscriber(string, uint, uint, uint)"/>
        public static bool add_subscriber(string topic, int type, int libraryBacklog, int rosBacklog) =>
            add_subscriber(topic, Number(type), Unsigned(libraryBacklog), Unsigned(rosBacklog));

        /// <summary>Sends a message of whatever type the publisher has.</summary>
        public static bool send(string topic, IMessage message)
        {
            lock (Gate)
            {
                if (!Pumped())
                {
                    return Failed("send", topic, "call ros2_init first");
                }
                if (!Publishers.TryGetValue(topic ?? "", out Publisher publisher))
                {
                    return Failed("send", topic, "no publisher: call add_publisher first");
                }
                return message != null
                    ? publisher.Publish(message)
                    : Failed("send", topic, "no message");
            }
        }

        /// <summary>Takes the oldest unread message of whatever type the subscriber has.</summary>
        /// <returns>False without a message or a subscriber, or if it is of another type: then it stays.</returns>
        public static bool poll<T>(string topic, out T message)
            where T : class, IMessage =>
            Poll("poll", topic, out message);

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

        private static bool Poll<T>(string call, string topic, out T message)
            where T : class, IMessage
        {
            lock (Gate)
            {
                return Oldest(call, topic, out message) && Taken(topic, message);
            }
        }

        // The oldest unread message, which stays until it is taken.
        private static bool Oldest<T>(string call, string topic, out T message)
            where T : class, IMessage
        {
            message = null;
            if (!Pumped())
            {
                return Failed(call, topic, "call ros2_init first");
            }
            if (!Subscribers.TryGetValue(topic ?? "", out Subscription<IMessage> subscriber))
            {
                return Failed(call, topic, "no subscriber: call add_subscriber first");
            }
            if (!subscriber.TryPeek(out IMessage oldest))
            {
                return false;
            }
            message = oldest as T;
            return message != null || Failed(call, topic, "the subscriber has type " + subscriber.Type);
        }

        private static bool Taken(string topic, IMessage message)
        {
            Subscribers[topic].Remove(message);
            return true;
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

        private static IMessage Example(string call, string topic, uint type)
        {
            if (!Pumped())
            {
                Failed(call, topic, "call ros2_init first");
                return null;
            }
            if (string.IsNullOrEmpty(topic))
            {
                Failed(call, "", "a topic is missing");
                return null;
            }
            RegisterOwn();
            IMessage example = MessageCatalogue.Create(type.ToString(CultureInfo.InvariantCulture));
            if (example == null)
            {
                string name = MessageCatalogue.Resolve(type.ToString(CultureInfo.InvariantCulture));
                Failed(call, topic, name == null
                    ? "there is no message type with the number " + type
                    : name + " has no class in this build: call MessageCatalogue.Register with it first");
            }
            return example;
        }

        // The types with separate calls, by their numbers.
        private static void RegisterOwn()
        {
            MessageCatalogue.Register<StringMsg>();
            MessageCatalogue.Register<TwistMsg>();
            MessageCatalogue.Register<HeaderMsg>();
            MessageCatalogue.Register<PoseWithCovarianceStampedMsg>();
            MessageCatalogue.Register<PoseStampedMsg>();
            MessageCatalogue.Register<ImageMsg>();
            MessageCatalogue.Register<BatteryStateMsg>();
            MessageCatalogue.Register<LaserScanMsg>();
            MessageCatalogue.Register<CompressedImageMsg>();
            MessageCatalogue.Register<OdometryMsg>();
        }

        // Once: nodes that come and go later are not business of the prefix.
        private static void CompareNodes(RosGraph graph)
        {
            _client.UnwatchGraph(CompareNodes);
            foreach (string node in graph.Nodes)
            {
                if (node.Substring(node.LastIndexOf('/') + 1).StartsWith(_prefix + "_", StringComparison.Ordinal))
                {
                    return;
                }
            }
            Remember("ros2_init: no node is named " + _prefix + "_...: to name its nodes so, start the gateway"
                + " with --node-prefix " + _prefix);
        }

        private static uint Number(int type) => type < 0 ? uint.MaxValue : (uint)type; // the table has no such number

        private static int Signed(uint backlog) => (int)Math.Min(backlog, int.MaxValue);

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
