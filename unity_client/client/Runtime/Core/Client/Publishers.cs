// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>All publishers of a client.</summary>
    internal sealed class Publishers
    {
        private readonly object _gate = new(); // held while sending, so that nothing overtakes its advertisement
        private readonly GatewayClient _client;
        private readonly List<Publisher> _all = new();

        internal Publishers(GatewayClient client) => _client = client;

        /// <summary>Who drives. Null until something asks.</summary>
        internal IDriving Driving;

        /// <summary>Milliseconds of a clock that never goes back, over all connections.</summary>
        internal long Now => _client.Clock.Now;

        internal void Add(Publisher publisher)
        {
            lock (_gate)
            {
                _all.Add(publisher);
                Advertise(publisher);
            }
        }

        /// <summary>Unadvertises, after what the publisher's queue still holds.</summary>
        internal void Remove(Publisher publisher, PublisherQueue queue)
        {
            lock (_gate)
            {
                _all.Remove(publisher);
                JsonWriter frame = queue.Rent();
                frame.Begin("unadvertise", publisher.Id);
                frame.Name("topic").Value(publisher.Topic);
                frame.EndObject();
                _client.Outbox.PostLast(queue, frame);
            }
        }

        /// <summary>Advertises all of them on a new connection, with what they had latched.</summary>
        internal void Restore()
        {
            lock (_gate)
            {
                foreach (Publisher publisher in _all)
                {
                    publisher.Advertisement.Forget();
                    Advertise(publisher);
                    publisher.Restore();
                }
            }
        }

        /// <summary>The topic of a publisher. Null if no one has that id.</summary>
        internal string TopicOf(string id) => Find(id)?.Topic;

        /// <summary>
        /// The gateway has refused something of a publisher, if there is one with that id. Returns whether that is
        /// known already.
        /// </summary>
        /// <param name="request">The operation that was refused.</param>
        internal bool OnRefused(string id, string request, string code, string errorText)
        {
            Publisher found = Find(id);
            if (found == null)
            {
                return false;
            }
            if (request == "advertise")
            {
                return !found.Advertisement.Refuse(errorText, _client.Clock.Now);
            }
            found.OnRefused(code, errorText);
            return false;
        }

        /// <summary>Advertises again what was refused, from time to time.</summary>
        internal void Tick(long now)
        {
            lock (_gate)
            {
                foreach (Publisher publisher in _all)
                {
                    if (publisher.Advertisement.IsDue(now))
                    {
                        Advertise(publisher);
                    }
                }
            }
        }

        /// <summary>A ping that left at that time is back, and every answer to what went before it.</summary>
        internal void OnPong(double sent)
        {
            lock (_gate)
            {
                foreach (Publisher publisher in _all)
                {
                    publisher.Advertisement.OnPong(sent);
                }
            }
        }

        internal QueueBound NewBound(int queue) => new QueueBound(_client.Mailbox, queue, true);

        internal Drops NewDrops(string topic, int queue)
        {
            string reason = queue <= 1 ? ""
                : "more than " + queue + " waited for the network: publish less, or advertise with a longer Queue";
            return new Drops(_client, "publish", topic, reason);
        }

        /// <summary>Hands a frame over. Returns why it does not go, or null.</summary>
        internal string Send(PublisherQueue queue, JsonWriter frame, bool evenLate) => _client.Outbox.Post(queue, frame, evenLate);

        /// <summary>
        /// Sends a frame that is kept for each connection: a state, so it goes in order with the requests.
        /// Returns why it is not to be kept, or null.
        /// </summary>
        internal string SendLatched(byte[] latched)
        {
            JsonWriter frame = _client.Outbox.Rent();
            frame.Raw(latched, 0, latched.Length);
            string refusal = _client.Outbox.Post(frame);
            return refusal == Outbox.NotConnected ? null : refusal;
        }

        internal void Report(Publisher publisher, string errorText) =>
            _client.Reports.Error("publish", publisher.Topic + ": " + errorText);

        private Publisher Find(string id)
        {
            lock (_gate)
            {
                return _all.Find(publisher => publisher.Id == id);
            }
        }

        private void Advertise(Publisher publisher)
        {
            _client.Outbox.Send("advertise", publisher.Id, frame =>
            {
                frame.Name("topic").Value(publisher.Topic);
                frame.Name("type").Value(publisher.Type);
                if (publisher.Options.Latch)
                {
                    frame.Name("latch").Value(true);
                }
                publisher.Options.Qos?.Write(frame);
            });
            publisher.Advertisement.Ask(_client.Clock.Precise); // a ping that leaves from now on comes after it
        }
    }
}
