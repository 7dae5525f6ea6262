// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>All publishers of a client.</summary>
    internal sealed class Publishers
    {
        private readonly object _gate = new object(); // held while sending, so that nothing overtakes its advertisement
        private readonly Outbox _outbox;
        private readonly Mailbox _mailbox;
        private readonly Reports _reports;
        private readonly Controls _controls;
        private readonly Clock _clock;
        private readonly List<Publisher> _all = new List<Publisher>();

        internal Publishers(Outbox outbox, Mailbox mailbox, Reports reports, Controls controls, Clock clock)
        {
            _outbox = outbox;
            _mailbox = mailbox;
            _reports = reports;
            _controls = controls;
            _clock = clock;
        }

        /// <summary>Milliseconds of a clock that never goes back, over all connections.</summary>
        internal long Now
        {
            get { return _clock.Now; }
        }

        internal void Add(Publisher publisher)
        {
            lock (_gate)
            {
                _all.Add(publisher);
                Advertise(publisher);
            }
            if (Velocities.IsType(publisher.Type))
            {
                publisher.Control = _controls.Open(publisher.Topic);
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
                frame.Member("topic", publisher.Topic);
                frame.EndObject();
                _outbox.PostLast(queue, frame);
            }
            if (publisher.Control != null)
            {
                _controls.Close(publisher.Control);
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
        internal string TopicOf(string id)
        {
            Publisher found = Find(id);
            return found == null ? null : found.Topic;
        }

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
                return !found.Advertisement.Refuse(errorText, _clock.Now);
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

        internal QueueBound NewBound(int queue)
        {
            return new QueueBound(_mailbox, queue, true);
        }

        internal Drops NewDrops(string topic, int queue)
        {
            string reason = queue <= 1 ? ""
                : "more than " + queue + " waited for the network: publish less, or advertise with a longer Queue";
            return new Drops(_mailbox, _reports, "publish", topic, reason);
        }

        /// <summary>Hands a frame over. Returns why it does not go, or null.</summary>
        internal string Send(PublisherQueue queue, JsonWriter frame, bool evenLate)
        {
            return _outbox.Post(queue, frame, evenLate);
        }

        /// <summary>
        /// Sends a frame that is kept for each connection: a state, so it goes in order with the requests.
        /// Returns why it is not to be kept, or null.
        /// </summary>
        internal string SendLatched(byte[] latched)
        {
            JsonWriter frame = _outbox.Rent();
            frame.Raw(latched, 0, latched.Length);
            string refusal = _outbox.Post(frame);
            return refusal == Outbox.NotConnected ? null : refusal;
        }

        internal void Report(Publisher publisher, string errorText)
        {
            _reports.Error("publish", publisher.Topic + ": " + errorText);
        }

        private Publisher Find(string id)
        {
            lock (_gate)
            {
                return _all.Find(publisher => publisher.Id == id);
            }
        }

        private void Advertise(Publisher publisher)
        {
            JsonWriter frame = _outbox.Rent();
            frame.Begin("advertise", publisher.Id);
            frame.Member("topic", publisher.Topic);
            frame.Member("type", publisher.Type);
            if (publisher.Options.Latch)
            {
                frame.Member("latch", true);
            }
            if (publisher.Options.Qos != null)
            {
                frame.Name("qos");
                publisher.Options.Qos.Write(frame);
            }
            frame.EndObject();
            _outbox.Post(frame);
            publisher.Advertisement.Ask(_clock.Precise); // a ping that leaves from now on comes after it
        }
    }
}
