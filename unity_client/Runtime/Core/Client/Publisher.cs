// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>Publishes on a topic. It survives reconnections and ends with <see cref="Dispose"/>.</summary>
    public class Publisher : IDisposable
    {
        // A refusal without a known end is asked for again after so long: soon enough not to miss a deadline.
        private const int AskAgainMilliseconds = 250;

        // A change of state tells when a stop is reset. If that was lost on the way, this ends the waiting.
        private const int ResetMilliseconds = 300;

        private readonly Publishers _publishers;
        private readonly PublisherQueue _queue;
        private readonly QueueBound _bound;
        private readonly Drops _drops;
        private byte[] _latched; // a frame, to be sent again with each connection
        private readonly Advertisement _advertisement = new Advertisement();
        private volatile Refused _refused;
        private string _told; // of the refusals, so that a held stick is one piece of news

        internal Publisher(Publishers publishers, string id, string topic, string type, AdvertiseOptions options)
        {
            _publishers = publishers;
            _bound = publishers.NewBound(options.Queue);
            _drops = publishers.NewDrops(topic, options.Queue);
            _queue = new PublisherQueue(_bound, _drops);
            Id = id;
            Topic = topic;
            Type = type;
            Options = options;
        }

        /// <summary>The topic, with its leading slash.</summary>
        public string Topic { get; private set; }

        /// <summary>pkg/msg/Name.</summary>
        public string Type { get; private set; }

        /// <summary>How many messages were taken over for sending.</summary>
        public long Published { get; private set; }

        /// <summary>How many of them made room for newer ones, or became too old, before they had left.</summary>
        public long Dropped
        {
            get { return _drops.Count; }
        }

        /// <summary>
        /// Messages were dropped: gets <see cref="Dropped"/>. Called by <see cref="GatewayClient.Pump"/>.
        /// </summary>
        public event Action<long> DroppedChanged
        {
            add { _drops.Listeners.Add(value); }
            remove { _drops.Listeners.Remove(value); }
        }

        /// <summary>
        /// Why the gateway takes nothing, or no command to move, now, in words, or null. Then <see cref="Publish"/>
        /// is false. On a command topic that is advertised for all but zeros, which reset a robot that was stopped.
        /// </summary>
        public string Refusal
        {
            get
            {
                string notAdvertised = _advertisement.Refusal;
                if (notAdvertised != null)
                {
                    return notAdvertised;
                }
                ControlState state = Control == null ? null : Control.State;
                if (state != null && state.Refusal != null)
                {
                    return state.Refusal;
                }
                // The last word counts: a state that came after the refusal knows better.
                Refused refused = _refused;
                return refused != null && refused.State == state && _publishers.Now < refused.Until
                    ? refused.Reason : null;
            }
        }

        /// <summary>The state of the robot that this may move. Null for messages that move none.</summary>
        internal ControlTopic Control { get; set; }

        internal string Id { get; private set; }

        internal AdvertiseOptions Options { get; private set; }

        /// <summary>Whether the gateway has taken it, as far as is known.</summary>
        internal Advertisement Advertisement
        {
            get { return _advertisement; }
        }

        internal bool IsDisposed { get; private set; }

        /// <summary>
        /// Sends a message. False, and an event says why, if there is no connection, if it cannot be written, or if
        /// the gateway has refused the topic or the motion, see <see cref="Refusal"/>. Also false if the gateway has
        /// left a ping unanswered for <see cref="GatewayOptions.FreshMilliseconds"/>. True does not promise
        /// that it leaves: while the network takes less than is published, the oldest that waits is dropped, see
        /// <see cref="AdvertiseOptions.Queue"/> and <see cref="DroppedChanged"/>.
        /// </summary>
        /// <remarks>
        /// Nothing is kept for later: a robot must not carry out what was meant for another moment. If a
        /// network stalls and comes back, the system's buffers do arrive late: as much as FreshMilliseconds
        /// allow. Only a latched message is kept, and goes out again with each connection.
        /// The message may be changed afterwards.
        /// </remarks>
        /// <param name="message">The message.</param>
        /// <param name="evenLate">
        /// For messages that are right whenever they arrive, such as a stop. The client also accepts one while the gateway
        /// does not answer. It goes when the network is back, if nothing newer has been published by then.
        /// </param>
        public bool Publish(IMessage message, bool evenLate = false)
        {
            string refusal = IsDisposed ? "publisher was disposed"
                : message == null ? "no message"
                : message.RosType != Type ? "expected " + Type + ", got " + message.RosType : null;
            if (refusal == null)
            {
                if (IsRefused(message))
                {
                    return false;
                }
                refusal = Send(message, evenLate);
            }
            if (refusal != null)
            {
                _publishers.Report(this, refusal);
            }
            return refusal == null;
        }

        /// <summary>Publishes no longer on this topic. Accepted messages still go.</summary>
        public void Dispose()
        {
            if (!IsDisposed)
            {
                IsDisposed = true;
                _publishers.Remove(this, _queue);
            }
        }

        /// <summary>Counts a message that was taken over, and then could not be made. Any thread.</summary>
        internal void Drop()
        {
            _drops.Add();
        }

        /// <summary>Sends what was latched, on a new connection.</summary>
        internal void Restore()
        {
            if (_latched != null && !MovesARobot) // a command that moved it once must not move it again
            {
                _publishers.SendLatched(_latched);
            }
        }

        /// <summary>The gateway has refused a message.</summary>
        internal void OnRefused(string code, string reason)
        {
            bool isTripped = code == "tripped";
            bool lasts = isTripped || code == "not_lease_holder" || code == "stale_command" || code == "forbidden"
                || (code == "invalid_value" && MovesARobot); // elsewhere the next message may be right
            if (!lasts)
            {
                return;
            }
            ControlState state = Control == null ? null : Control.State;
            bool isEndTold = isTripped && state != null && state.IsKnown;
            long until = isEndTold ? long.MaxValue : _publishers.Now + AskAgainMilliseconds;
            _told = reason; // it is an event already
            _refused = new Refused(reason, until, state);
        }

        private bool MovesARobot
        {
            get { return Control != null && Control.MovesARobot; }
        }

        private bool IsRefused(IMessage message)
        {
            string refusal = Refusal;
            if (refusal == null)
            {
                return false;
            }
            if (Control != null && _advertisement.Refusal == null && Velocities.MayBeZero(message))
            {
                Refused refused = _refused;
                if (refused != null && refused.Until == long.MaxValue)
                {
                    _refused = new Refused(refused.Reason, _publishers.Now + ResetMilliseconds, refused.State);
                }
                return false;
            }
            if (!ReferenceEquals(refusal, _told))
            {
                _told = refusal;
                _publishers.Report(this, refusal);
            }
            return true;
        }

        // Returns why it does not go, or null.
        private string Send(IMessage message, bool evenLate)
        {
            JsonWriter frame = _queue.Rent();
            try
            {
                Write(frame, message);
            }
            catch (Exception error)
            {
                // A message may be a class of the application's, which may throw anything.
                _queue.GiveBack(frame);
                return error.Message;
            }
            string refusal;
            if (Options.Latch && !MovesARobot)
            {
                byte[] latched = frame.ToArray();
                _queue.GiveBack(frame);
                refusal = _publishers.SendLatched(latched);
                _latched = refusal == null ? latched : _latched;
            }
            else
            {
                if (MovesARobot)
                {
                    _bound.Depth = 1; // a command that waited is one for a robot that is elsewhere by now
                }
                refusal = _publishers.Send(_queue, frame, evenLate);
            }
            Published += refusal == null ? 1 : 0;
            return refusal;
        }

        private void Write(JsonWriter frame, IMessage message)
        {
            frame.Begin("publish", Id);
            frame.Member("topic", Topic);
            if (!_advertisement.IsAgreed)
            {
                frame.Member("type", Type);
            }
            if (Control != null)
            {
                // by which the gateway tells commands that are late
                frame.Member("monotonic_ms", _publishers.Now);
            }
            frame.Name("msg");
            message.Write(frame);
            frame.EndObject();
        }

        /// <summary>A refusal: its reason, its end, and the state that was known when it came.</summary>
        private sealed class Refused
        {
            internal readonly string Reason;
            internal readonly long Until;
            internal readonly ControlState State;

            internal Refused(string reason, long until, ControlState state)
            {
                Reason = reason;
                Until = until;
                State = state;
            }
        }
    }

    /// <summary>Publishes messages of type T.</summary>
    public sealed class Publisher<T> : Publisher
        where T : IMessage
    {
        internal Publisher(Publishers publishers, string id, string topic, string type, AdvertiseOptions options)
            : base(publishers, id, topic, type, options)
        {
        }

        /// <inheritdoc cref="Publisher.Publish(IMessage, bool)"/>
        public bool Publish(T message, bool evenLate = false)
        {
            return base.Publish(message, evenLate);
        }
    }
}
