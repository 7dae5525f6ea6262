// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Json;
using Ros2Gateway.Messages.GeometryMsgs;

namespace Ros2Gateway
{
    /// <summary>Publishes on a topic. It survives reconnections and ends with <see cref="Dispose"/>.</summary>
    public class Publisher : IDisposable
    {
        private readonly Publishers _publishers;
        private readonly PublisherQueue _queue;
        private readonly Drops _drops;
        private byte[] _latched; // a frame, to be sent again with each connection
        private readonly Advertisement _advertisement = new();
        private readonly bool _isVelocity; // which may move a robot
        private string _told; // of the refusals, so that a held stick is one piece of news

        internal Publisher(Publishers publishers, string id, string topic, string type, AdvertiseOptions options)
        {
            _publishers = publishers;
            _isVelocity = type == TwistMsg.Type || type == TwistStampedMsg.Type;
            int queue = _isVelocity ? 1 : options.Queue; // a late command is one for a robot that is elsewhere by now
            _drops = publishers.NewDrops(topic, queue);
            _queue = new PublisherQueue(publishers.NewBound(queue), _drops);
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
        public long Dropped => _drops.Count;

        /// <summary>
        /// Messages were dropped: gets <see cref="Dropped"/>. Called by <see cref="GatewayClient.Pump"/>.
        /// </summary>
        public event Action<long> DroppedChanged
        {
            add => _drops.Listeners.Add(value);
            remove => _drops.Listeners.Remove(value);
        }

        /// <summary>
        /// Why the gateway does not take the topic now, in words, or null. Then <see cref="Publish"/> is false. If you
        /// watch who drives by the package <c>displays</c>, also why the robot takes no command to move.
        /// </summary>
        public string Refusal => _advertisement.Refusal ?? Driving?.RefusalOf(Topic);

        internal string Id { get; private set; }

        internal AdvertiseOptions Options { get; private set; }

        /// <summary>Whether the gateway has taken it, as far as is known.</summary>
        internal Advertisement Advertisement => _advertisement;

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
        internal void Drop() => _drops.Add();

        /// <summary>Sends what was latched, on a new connection.</summary>
        internal void Restore()
        {
            if (_latched != null)
            {
                _publishers.SendLatched(_latched);
            }
        }

        /// <summary>The gateway has refused a message.</summary>
        internal void OnRefused(string code, string reason)
        {
            if (Driving?.OnRefused(Topic, code, reason) == true)
            {
                _told = reason; // it is an event already
            }
        }

        private IDriving Driving => _isVelocity ? _publishers.Driving : null;

        private bool IsRefused(IMessage message)
        {
            string notAdvertised = _advertisement.Refusal;
            string refusal = notAdvertised ?? Driving?.RefusalOf(Topic);
            if (refusal == null || (notAdvertised == null && Driving.TakesAnyway(Topic, message)))
            {
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
            if (Options.Latch && !_isVelocity) // a command that moved a robot once must not move it again
            {
                byte[] latched = frame.ToArray();
                _queue.GiveBack(frame);
                refusal = _publishers.SendLatched(latched);
                _latched = refusal == null ? latched : _latched;
            }
            else
            {
                refusal = _publishers.Send(_queue, frame, evenLate);
            }
            Published += refusal == null ? 1 : 0;
            return refusal;
        }

        private void Write(JsonWriter frame, IMessage message)
        {
            frame.Begin("publish", Id);
            frame.Name("topic").Value(Topic);
            if (!_advertisement.IsAgreed)
            {
                frame.Name("type").Value(Type);
            }
            if (_isVelocity)
            {
                // by which the gateway tells commands that are late
                frame.Name("monotonic_ms").Value(_publishers.Now);
            }
            frame.Name("msg");
            message.Write(frame);
            frame.EndObject();
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
        public bool Publish(T message, bool evenLate = false) => base.Publish(message, evenLate);
    }
}
