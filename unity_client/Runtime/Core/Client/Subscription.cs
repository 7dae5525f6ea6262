// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>A subscription to a topic. It survives reconnections and ends with <see cref="Dispose"/>.</summary>
    public abstract class Subscription : IDisposable
    {
        private readonly Subscriptions _subscriptions;

        internal Subscription(
            Subscriptions subscriptions, string id, string topic, string type, SubscribeOptions options)
        {
            _subscriptions = subscriptions;
            Id = id;
            Topic = topic;
            Type = type;
            Options = options;
        }

        /// <summary>The topic, with its leading slash.</summary>
        public string Topic { get; private set; }

        /// <summary>pkg/msg/Name; empty where it is left to the gateway to find out.</summary>
        public string Type { get; private set; }

        /// <summary>How many messages have come from the gateway.</summary>
        public long Received { get; protected set; }

        /// <summary>How many messages the application was too slow for: they made room for newer ones.</summary>
        public long Dropped { get; private set; }

        /// <summary>How many messages could not be read as <see cref="Type"/>; events say why.</summary>
        public long Unreadable { get; internal set; }

        internal string Id { get; private set; }

        internal SubscribeOptions Options { get; private set; }

        /// <summary>Ends the subscription; its handler is not called again.</summary>
        public void Dispose()
        {
            IsDisposed = true;
            _subscriptions.Remove(this);
        }

        internal bool IsDisposed { get; private set; }

        /// <summary>Notes that a message made room for a newer one; on the thread that reads frames.</summary>
        protected void CountDrop()
        {
            Dropped++;
            _subscriptions.Dropped++;
        }

        /// <summary>Reads one message and keeps it for the application; on the thread that reads frames.</summary>
        internal abstract void Deliver(JsonReader reader);

        /// <summary>Gives one message to the handler, if one waits; on the application's thread.</summary>
        internal abstract bool HandOut();
    }

    /// <summary>A subscription whose messages are of type T.</summary>
    /// <remarks>Messages go to the handler while the client is pumped; without a handler take them yourself.</remarks>
    public sealed class Subscription<T> : Subscription
        where T : IMessage
    {
        private readonly Func<T> _create;
        private readonly Action<T> _handler;
        private readonly Mailbox _mailbox;
        private readonly Queue<T> _waiting;
        private readonly int _depth;
        private bool _isReady; // stands in the mailbox's queue

        internal Subscription(
            Subscriptions subscriptions, Mailbox mailbox, string id, string topic, string type,
            SubscribeOptions options, Func<T> create, Action<T> handler)
            : base(subscriptions, id, topic, type, options)
        {
            _create = create;
            _handler = handler;
            _mailbox = mailbox;
            _depth = options.Queue < 1 ? 1 : options.Queue;
            _waiting = new Queue<T>(Math.Min(_depth, 16));
        }

        /// <summary>How many messages wait to be taken.</summary>
        public int Waiting
        {
            get
            {
                lock (_waiting)
                {
                    return _waiting.Count;
                }
            }
        }

        /// <summary>Takes the oldest message that waits; false if none does. Any thread.</summary>
        public bool TryTake(out T message)
        {
            lock (_waiting)
            {
                if (_waiting.Count > 0)
                {
                    message = _waiting.Dequeue();
                    return true;
                }
            }
            message = default(T);
            return false;
        }

        internal override void Deliver(JsonReader reader)
        {
            T message = _create();
            message.Read(reader);
            bool becameReady;
            lock (_waiting)
            {
                if (_waiting.Count >= _depth)
                {
                    _waiting.Dequeue();
                    CountDrop();
                }
                _waiting.Enqueue(message);
                Received++;
                becameReady = _handler != null && !_isReady;
                _isReady |= becameReady;
            }
            if (becameReady)
            {
                _mailbox.Ready(this);
            }
        }

        internal override bool HandOut()
        {
            T message;
            lock (_waiting)
            {
                if (_waiting.Count == 0 || IsDisposed)
                {
                    _isReady = false;
                    return false;
                }
                message = _waiting.Dequeue();
            }
            _handler(message);
            return true;
        }
    }
}
