// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>Publishes on a topic. It survives reconnections and ends with <see cref="Dispose"/>.</summary>
    public class Publisher : IDisposable
    {
        private readonly Publishers _publishers;
        private readonly Lane _lane;
        private byte[] _latched; // a frame, to be sent again with each connection

        internal Publisher(Publishers publishers, string id, string topic, string type, AdvertiseOptions options)
        {
            _publishers = publishers;
            _lane = new Lane(options.Queue);
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
            get { return _lane.Dropped; }
        }

        internal string Id { get; private set; }

        internal AdvertiseOptions Options { get; private set; }

        internal bool IsDisposed { get; private set; }

        /// <summary>
        /// Sends a message; false, and an event says why, if there is no connection, if the gateway has left a
        /// ping unanswered for <see cref="GatewayOptions.FreshMilliseconds"/>, or if it cannot be written.
        /// </summary>
        /// <remarks>
        /// Nothing is kept for later: a robot must not carry out what was meant for another moment. What the
        /// system's buffers hold when a network stalls does arrive late, if it comes back: so much as
        /// FreshMilliseconds allow. Only a latched message is kept, and goes out again with each connection.
        /// The message may be changed afterwards.
        /// </remarks>
        /// <param name="message">What is sent.</param>
        /// <param name="evenLate">
        /// For what is right whenever it arrives, a stop above all: it is taken while the gateway does not
        /// answer, too, and goes when the network is back, if nothing newer has been published by then.
        /// </param>
        public bool Publish(IMessage message, bool evenLate = false)
        {
            string refusal = IsDisposed ? "publisher was disposed"
                : message == null ? "no message"
                : message.RosType != Type ? "expected " + Type + ", got " + message.RosType
                : Send(message, evenLate);
            if (refusal != null)
            {
                _publishers.Report(this, refusal);
            }
            return refusal == null;
        }

        /// <summary>Publishes no longer on this topic; what was taken over still goes.</summary>
        public void Dispose()
        {
            if (!IsDisposed)
            {
                IsDisposed = true;
                _publishers.Remove(this, _lane);
            }
        }

        /// <summary>Sends what was latched, on a new connection.</summary>
        internal void Restore()
        {
            if (_latched != null)
            {
                _publishers.SendLatched(_latched);
            }
        }

        // Returns why it does not go, or null.
        private string Send(IMessage message, bool evenLate)
        {
            JsonWriter frame = _lane.Rent();
            try
            {
                Write(frame, message);
            }
            catch (Exception error)
            {
                // A message may be a class of the application's, which may throw anything.
                _lane.GiveBack(frame);
                return error.Message;
            }
            string refusal;
            if (Options.Latch)
            {
                byte[] latched = frame.ToArray();
                _lane.GiveBack(frame);
                refusal = _publishers.SendLatched(latched);
                _latched = refusal == null ? latched : _latched;
            }
            else
            {
                refusal = _publishers.Send(_lane, frame, evenLate);
            }
            Published += refusal == null ? 1 : 0;
            return refusal;
        }

        private void Write(JsonWriter frame, IMessage message)
        {
            frame.Begin("publish", Id);
            frame.Member("topic", Topic);
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

        /// <inheritdoc cref="Publisher.Publish(IMessage)"/>
        public bool Publish(T message, bool evenLate = false)
        {
            return base.Publish(message, evenLate);
        }
    }
}
