// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;
using System.Linq;
using System.Threading;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>All topics that may move a robot and that this client uses: watched while anybody does.</summary>
    internal sealed class Controls : IDriving
    {
        // Longer than a lease: the gateway may take the lost connection for a client that drives until then.
        private const int TakeBackMilliseconds = 5000;

        private readonly object _gate = new();
        private readonly GatewayClient _client;
        private readonly Dictionary<string, ControlTopic> _topics = new();

        private Controls(GatewayClient client) => _client = client;

        /// <summary>Those of a client, made when they are asked for first.</summary>
        internal static Controls Of(GatewayClient client)
        {
            Publishers publishers = client.Publishers;
            if (publishers.Driving == null)
            {
                Interlocked.CompareExchange(ref publishers.Driving, new Controls(client), null);
            }
            return (Controls)publishers.Driving;
        }

        public string RefusalOf(string topic) => Find(topic)?.Refusal;

        public bool TakesAnyway(string topic, IMessage message)
        {
            bool isZero = Velocities.MayBeZero(message);
            if (isZero)
            {
                Find(topic)?.OnZero();
            }
            return isZero;
        }

        public bool OnRefused(string topic, string code, string reason) =>
            Find(topic)?.OnRefused(code, reason) ?? false;

        /// <summary>Watches a topic from now on, until it is closed as often as it was opened.</summary>
        internal ControlTopic Open(string name)
        {
            ControlTopic topic;
            bool isFirst;
            lock (_gate)
            {
                if (!_topics.TryGetValue(name, out topic))
                {
                    topic = new ControlTopic(name, _client);
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
        public void Restore()
        {
            long until = _client.Clock.Now + TakeBackMilliseconds;
            foreach (ControlTopic topic in All())
            {
                lock (_gate)
                {
                    topic.TakeBackUntil = topic.TakeBackUntil > 0 ? until : 0;
                }
                Watch(topic, true);
            }
        }

        public void OnDown()
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
        public void OnFrame(string op, JsonReader reader)
        {
            JsonValue frame = JsonValue.Read(reader);
            ControlState state = ControlState.Read(frame);
            if (frame["clamped"].AsBool())
            {
                _client.Reports.Tell(
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
                isTakenBack = state.Holder == ControlHolder.None && _client.Clock.Now < topic.TakeBackUntil
                    && op == "control";
                if (isTakenBack || state.Holder == ControlHolder.You || _client.Clock.Now >= topic.TakeBackUntil)
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
        public bool OnUnknown(string id, string errorText)
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
                _client.Reports.Error("stop", refusal);
            }
        }

        private ControlTopic Find(string topic)
        {
            lock (_gate)
            {
                return _topics.TryGetValue(topic, out ControlTopic found) ? found : null;
            }
        }

        private ControlTopic[] All()
        {
            lock (_gate)
            {
                return _topics.Values.ToArray();
            }
        }

        private void Watch(ControlTopic topic, bool watch) => _client.Outbox.Send("control", topic.Id, frame =>
        {
            frame.Name("topic").Value(topic.Name);
            frame.Name("watch").Value(watch);
        });

        // Returns why it does not go, or null.
        private string Send(string op, string id, string topic) => _client.Outbox.Send(op, id, frame =>
        {
            if (topic != null)
            {
                frame.Name("topic").Value(topic);
            }
        });
    }
}
