// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>All subscriptions of a client, by topic.</summary>
    internal sealed class Subscriptions
    {
        // The longest queue of the gateway for a client on a topic. More may wait here.
        private const int MaxGatewayQueue = 1024;

        // The types for which binary frames save most: base64 is a third longer than its octets, and a float as text takes 35
        // times as long to read.
        private static readonly string[] MostlyArrays =
        {
            "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage", "sensor_msgs/msg/LaserScan",
            "sensor_msgs/msg/PointCloud2", "nav_msgs/msg/OccupancyGrid",
        };

        private static readonly Subscription[] None = new Subscription[0];

        private readonly object _gate = new();
        private readonly Outbox _outbox;

        // Arrays are replaced, never changed: the thread that reads frames holds no lock while it delivers.
        private readonly Dictionary<string, Subscription[]> _byTopic = new();

        internal Subscriptions(Outbox outbox) => _outbox = outbox;

        /// <summary>How many messages made room for newer ones, in all that ever were.</summary>
        internal long Dropped { get; set; }

        internal void Add(Subscription subscription)
        {
            lock (_gate)
            {
                Subscription[] before = Of(subscription.Topic);
                Subscription[] after = new Subscription[before.Length + 1];
                before.CopyTo(after, 0);
                after[before.Length] = subscription;
                _byTopic[subscription.Topic] = after;
                if (before.Length > 0)
                {
                    // Else the gateway would count the newcomer as one more of the same client, and not
                    // send what is latched again.
                    Unsubscribe(subscription.Topic, null);
                }
                Send(after);
            }
        }

        internal void Remove(Subscription subscription)
        {
            lock (_gate)
            {
                Subscription[] before = Of(subscription.Topic);
                Subscription[] after = Array.FindAll(before, one => one != subscription);
                if (after.Length == before.Length)
                {
                    return;
                }
                if (after.Length == 0)
                {
                    _byTopic.Remove(subscription.Topic);
                }
                else
                {
                    _byTopic[subscription.Topic] = after;
                }
                Unsubscribe(subscription.Topic, subscription.Id);
            }
        }

        /// <summary>Asks again, after its options have changed.</summary>
        internal void SendAgain(Subscription subscription)
        {
            lock (_gate)
            {
                Subscription[] all = Of(subscription.Topic);
                if (Array.IndexOf(all, subscription) >= 0)
                {
                    Send(all);
                }
            }
        }

        /// <summary>The topic of a subscription. Null if no one has that id.</summary>
        internal string TopicOf(string id)
        {
            lock (_gate)
            {
                foreach (KeyValuePair<string, Subscription[]> topic in _byTopic)
                {
                    if (Array.Exists(topic.Value, one => one.Id == id))
                    {
                        return topic.Key;
                    }
                }
                return null;
            }
        }

        /// <summary>Those to a topic. The array never changes.</summary>
        internal Subscription[] Of(string topic)
        {
            lock (_gate)
            {
                return _byTopic.TryGetValue(topic, out Subscription[] subscriptions) ? subscriptions : None;
            }
        }

        /// <summary>Asks the gateway for all of them, on a new connection.</summary>
        internal void Restore()
        {
            lock (_gate)
            {
                foreach (Subscription[] subscriptions in _byTopic.Values)
                {
                    Send(subscriptions);
                }
            }
        }

        // All to one topic. The gateway serves them by one stream with the shortest of their queues and the newest
        // one's pictures, so each has to ask for the longest and the largest. A message with the same
        // id it replaces.
        private void Send(Subscription[] subscriptions)
        {
            int queue = 1;
            foreach (Subscription subscription in subscriptions)
            {
                queue = Math.Max(queue, subscription.Options.Queue);
            }
            queue = Math.Min(queue, MaxGatewayQueue);
            // A client that asks for a number gets that many, however old. Left to itself the gateway keeps a burst
            // whole, and of what a slow link cannot take the newest.
            queue = queue > 1 && queue <= SubscribeOptions.DefaultQueue ? 0 : queue;
            int width = Largest(subscriptions, image => image.MaxWidth);
            int height = Largest(subscriptions, image => image.MaxHeight);
            foreach (Subscription subscription in subscriptions)
            {
                Send(subscription, queue, width, height);
            }
        }

        // Of bounds in pixels. 0, which means no limit, is the largest.
        private static int Largest(Subscription[] subscriptions, Func<ImageOptions, int> bound)
        {
            int largest = 1;
            foreach (Subscription subscription in subscriptions)
            {
                int own = subscription.Image == null ? 0 : bound(subscription.Image);
                largest = own <= 0 || largest == 0 ? 0 : Math.Max(largest, own);
            }
            return largest;
        }

        // Without an id, all to the topic.
        private void Unsubscribe(string topic, string id)
        {
            JsonWriter frame = _outbox.Rent();
            frame.Begin("unsubscribe", id);
            frame.Name("topic").Value(topic);
            frame.EndObject();
            _outbox.Post(frame);
        }

        private void Send(Subscription subscription, int queue, int maxWidth, int maxHeight)
        {
            SubscribeOptions options = subscription.Options;
            _outbox.Send("subscribe", subscription.Id, frame =>
            {
                frame.Name("topic").Value(subscription.Topic);
                if (!string.IsNullOrEmpty(subscription.Type))
                {
                    frame.Name("type").Value(subscription.Type);
                }
                if (options.ThrottleMilliseconds > 0)
                {
                    frame.Name("throttle_rate").Value(options.ThrottleMilliseconds);
                }
                if (queue > 0)
                {
                    frame.Name("queue_length").Value(queue);
                }
                if (options.Binary ?? Array.IndexOf(MostlyArrays, subscription.Type) >= 0)
                {
                    frame.Name("compression").Value("cbor");
                }
                frame.Name("nonfinite").Value("string"); // without it infinities are null, and read as NaN
                if (options.Fields != null)
                {
                    frame.Name("fields");
                    frame.Values(options.Fields);
                }
                subscription.Image?.Write(frame, maxWidth, maxHeight);
                options.Qos?.Write(frame);
            });
        }
    }
}
