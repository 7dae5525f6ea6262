// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>All topics that may move a robot and that this client uses: watched while anybody does.</summary>
    internal sealed class Controls
    {
        // Longer than a lease: the gateway may take the lost connection for a client that drives until then.
        private const int TakeBackMilliseconds = 5000;

        private readonly object _gate = new object();
        private readonly Outbox _outbox;
        private readonly Mailbox _mailbox;
        private readonly Reports _reports;
        private readonly Clock _clock;
        private readonly Dictionary<string, ControlTopic> _topics = new Dictionary<string, ControlTopic>();

        internal Controls(Outbox outbox, Mailbox mailbox, Reports reports, Clock clock)
        {
            _outbox = outbox;
            _mailbox = mailbox;
            _reports = reports;
            _clock = clock;
        }

        /// <summary>Watches a topic from now on, until it is closed as often as it was opened.</summary>
        internal ControlTopic Open(string name)
        {
            ControlTopic topic;
            bool isFirst;
            lock (_gate)
            {
                if (!_topics.TryGetValue(name, out topic))
                {
                    topic = new ControlTopic(name, _mailbox);
                    _topics[name] = topic;
                }
                isFirst = topic.Users == 0;
                topic.Users++;
            }
            if (isFirst)
            {
                Watch(topic, true);
            }
            return topic;
        }

        internal void Close(ControlTopic topic)
        {
            lock (_gate)
            {
                topic.Users--;
                if (topic.Users > 0)
                {
                    return;
                }
                _topics.Remove(topic.Name);
            }
            if (topic.State.IsKnown)
            {
                Watch(topic, false);
            }
        }

        /// <summary>Control is given back: no connection takes it back.</summary>
        internal void GiveBack(ControlTopic topic)
        {
            lock (_gate)
            {
                topic.IsAskedFor = false;
                topic.TakeBackUntil = 0;
            }
        }

        /// <summary>Asks again, on a new connection.</summary>
        internal void Restore()
        {
            long until = _clock.Now + TakeBackMilliseconds;
            foreach (ControlTopic topic in All())
            {
                lock (_gate)
                {
                    topic.TakeBackUntil = topic.TakeBackUntil > 0 ? until : 0;
                }
                Watch(topic, true);
            }
        }

        internal void OnDown()
        {
            foreach (ControlTopic topic in All())
            {
                lock (_gate)
                {
                    topic.TakeBackUntil = topic.IsAskedFor ? long.MaxValue : topic.TakeBackUntil;
                    topic.IsAskedFor = false;
                }
                topic.Forget();
            }
        }

        /// <summary>The gateway tells the state of a topic, asked or not.</summary>
        internal void OnFrame(string op, JsonReader reader)
        {
            JsonValue frame = JsonValue.Read(reader);
            ControlState state = ControlState.Read(frame);
            if (frame["clamped"].AsBool())
            {
                _reports.Tell(
                    EventLevel.Warning, state.Topic + ": a command was too fast, so the gateway reduced it", "clamped", "publish");
            }
            ControlTopic topic;
            bool isTakenBack;
            lock (_gate)
            {
                if (!_topics.TryGetValue(state.Topic, out topic))
                {
                    return; // it was on its way when the last user left
                }
                topic.IsAskedFor = state.Holder == ControlHolder.You && (topic.IsAskedFor || op == "acquire_control");
                isTakenBack = state.Holder == ControlHolder.None && _clock.Now < topic.TakeBackUntil
                    && op == "control";
                if (isTakenBack || state.Holder == ControlHolder.You || _clock.Now >= topic.TakeBackUntil)
                {
                    topic.TakeBackUntil = 0;
                }
            }
            topic.Set(state);
            if (isTakenBack)
            {
                Send("acquire_control", null, topic.Name);
            }
        }

        /// <summary>
        /// The gateway refuses to tell a state. False if that is not an answer to a question of ours. It is not an event:
        /// most topics with velocities move no robot, and gateways of old know no control.
        /// </summary>
        internal bool OnRefused(string id, string errorText)
        {
            foreach (ControlTopic topic in All())
            {
                if (topic.Id == id)
                {
                    topic.Set(new ControlState(topic.Name, errorText));
                    return true;
                }
            }
            return false;
        }

        /// <summary>Stops one robot, or all without a topic. Nobody waits for the answer.</summary>
        internal void Stop(string topic)
        {
            string refusal = Send("stop", "stop", topic);
            if (refusal != null)
            {
                _reports.Error("stop", refusal);
            }
        }

        private ControlTopic[] All()
        {
            lock (_gate)
            {
                ControlTopic[] all = new ControlTopic[_topics.Count];
                _topics.Values.CopyTo(all, 0);
                return all;
            }
        }

        private void Watch(ControlTopic topic, bool watch)
        {
            JsonWriter frame = _outbox.Rent();
            frame.Begin("control", topic.Id);
            frame.Member("topic", topic.Name);
            frame.Member("watch", watch);
            frame.EndObject();
            _outbox.Post(frame);
        }

        // Returns why it does not go, or null.
        private string Send(string op, string id, string topic)
        {
            JsonWriter frame = _outbox.Rent();
            frame.Begin(op, id);
            if (topic != null)
            {
                frame.Member("topic", topic);
            }
            frame.EndObject();
            return _outbox.Post(frame);
        }
    }
}
