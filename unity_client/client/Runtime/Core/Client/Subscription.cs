// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>A subscription to a topic. It survives reconnections and ends with <see cref="Dispose"/>.</summary>
    public abstract class Subscription : IDisposable
    {
        /// <summary>How often its handler has thrown. For <see cref="Mailbox.ReportFault"/>.</summary>
        internal long HandlerFaults;

        private readonly Subscriptions _subscriptions;
        private readonly Drops _drops;

        internal Subscription(
            Subscriptions subscriptions, Drops drops, string id, string topic, string type, SubscribeOptions options)
        {
            _subscriptions = subscriptions;
            _drops = drops;
            Id = id;
            Topic = topic;
            Type = type;
            Options = options;
            Image = options.Image;
        }

        /// <summary>The topic, with its leading slash.</summary>
        public string Topic { get; private set; }

        /// <summary>pkg/msg/Name. Empty where it is left to the gateway to find out.</summary>
        public string Type { get; private set; }

        /// <summary>How many messages have come from the gateway.</summary>
        public long Received { get; protected set; }

        /// <summary>How many messages the application was too slow for: they made room for newer ones.</summary>
        public long Dropped => _drops.Count;

        /// <summary>
        /// Messages were dropped: gets <see cref="Dropped"/>. Called by <see cref="GatewayClient.Pump"/>.
        /// </summary>
        public event Action<long> DroppedChanged
        {
            add => _drops.Listeners.Add(value);
            remove => _drops.Listeners.Remove(value);
        }

        /// <summary>How many messages could not be read as <see cref="Type"/>. Events say why.</summary>
        public long Unreadable { get; internal set; }

        internal string Id { get; private set; }

        internal SubscribeOptions Options { get; private set; }

        internal ImageOptions Image { get; private set; }

        /// <summary>
        /// Asks for pictures of another size, quality or rate from now on. Null for the gateway's defaults. Of several
        /// subscriptions to a topic the largest size counts, and else what the newest asks for.
        /// </summary>
        public void ChangeImage(ImageOptions image)
        {
            Image = image;
            _subscriptions.SendAgain(this);
        }

        /// <summary>Ends the subscription. Its handler is not called again.</summary>
        public void Dispose()
        {
            IsDisposed = true;
            _subscriptions.Remove(this);
        }

        internal bool IsDisposed { get; private set; }

        /// <summary>Notes that a message made room for a newer one. On the thread that reads frames.</summary>
        protected void CountDrop()
        {
            _drops.Add();
            _subscriptions.Dropped++;
        }

        /// <summary>Reads one message and keeps it for the application. On the thread that reads frames.</summary>
        internal abstract void Deliver(JsonReader reader);

        /// <summary>Gives one message to the handler, if one waits. On the application's thread.</summary>
        internal abstract bool HandOut();
    }

    /// <summary>A subscription whose messages are of type T.</summary>
    /// <remarks>Messages go to the handler while the client is pumped. Without a handler take them yourself.</remarks>
    public sealed class Subscription<T> : Subscription
        where T : IMessage
    {
        private readonly Func<T> _create;
        private readonly Action<T> _handler;
        private readonly Action<T> _prepare;
        private readonly Mailbox _mailbox;
        private readonly Queue<(T Message, int Bytes)> _waiting; // and how long each was on the wire
        private readonly QueueBound _bound;
        private readonly Stack<T> _free; // null unless messages are used again
        private long _prepareFaults;
        private T _handedOut; // the last, until the next one
        private bool _hasHandedOut;
        private bool _isReady; // stands in the mailbox's queue

        internal Subscription(
            Subscriptions subscriptions, Mailbox mailbox, Drops drops, string id, string topic, string type,
            SubscribeOptions options, Func<T> create, Action<T> handler, Action<T> prepare, bool reuse)
            : base(subscriptions, drops, id, topic, type, options)
        {
            _create = create;
            _handler = handler;
            _prepare = prepare;
            _mailbox = mailbox;
            _bound = new QueueBound(mailbox, options.Queue, options.KeepsBursts);
            _waiting = new Queue<(T Message, int Bytes)>(Math.Min(_bound.Depth, 16));
            _free = reuse ? new Stack<T>() : null;
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

        /// <summary>
        /// Takes the oldest message that waits. False if none does. Any thread. If messages are used again it is
        /// the caller's until the next one is taken.
        /// </summary>
        public bool TryTake(out T message)
        {
            lock (_waiting)
            {
                if (_waiting.Count > 0)
                {
                    message = HandOutOldest();
                    return true;
                }
            }
            message = default(T);
            return false;
        }

        /// <summary>Looks at the oldest message, which stays.</summary>
        internal bool TryPeek(out T message)
        {
            lock (_waiting)
            {
                message = _waiting.Count > 0 ? _waiting.Peek().Message : default(T);
                return _waiting.Count > 0;
            }
        }

        /// <summary>Takes the oldest message if it is still this one. Else it has made room for newer ones.</summary>
        internal void Remove(T message)
        {
            lock (_waiting)
            {
                if (_waiting.Count > 0 && ReferenceEquals(_waiting.Peek().Message, message))
                {
                    TakeOldest();
                }
            }
        }

        internal override void Deliver(JsonReader reader)
        {
            T message = Rent();
            int begin = reader.Position;
            message.Read(reader);
            int bytes = reader.Position - begin;
            Prepare(message);
            bool becameReady;
            lock (_waiting)
            {
                _waiting.Enqueue((message, bytes));
                _bound.Add(bytes);
                while (_bound.IsExceeded)
                {
                    T dropped = TakeOldest();
                    _free?.Push(dropped);
                    CountDrop();
                }
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
                message = HandOutOldest();
            }
            _handler(message);
            return true;
        }

        private void Prepare(T message)
        {
            if (_prepare == null)
            {
                return;
            }
            try
            {
                _prepare(message);
            }
            catch (Exception error)
            {
                // The message was read, and is the handler's all the same.
                _prepareFaults++;
                _mailbox.ReportFault("prepare of " + Topic, error, _prepareFaults);
            }
        }

        private T Rent()
        {
            lock (_waiting)
            {
                if (_free != null && _free.Count > 0)
                {
                    return _free.Pop();
                }
            }
            return _create();
        }

        // Within the lock. With the next message the one before is no longer the application's.
        private T HandOutOldest()
        {
            T message = TakeOldest();
            if (_free != null)
            {
                if (_hasHandedOut)
                {
                    _free.Push(_handedOut);
                }
                _handedOut = message;
                _hasHandedOut = true;
            }
            return message;
        }

        private T TakeOldest()
        {
            (T message, int bytes) = _waiting.Dequeue();
            _bound.Remove(bytes);
            return message;
        }
    }
}
