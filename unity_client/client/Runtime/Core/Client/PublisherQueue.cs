// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>The frames of one publisher that wait, within a bound, the oldest being dropped.</summary>
    internal sealed class PublisherQueue
    {
        private readonly QueueBound _bound;
        private readonly Drops _drops;
        private readonly Queue<JsonWriter> _waiting = new();
        private readonly Stack<JsonWriter> _free = new();
        private JsonWriter _last; // after all others, and never dropped for what is newer
        private bool _keepsNewest; // which is right even when it comes late

        /// <param name="drops">Count those that made room for newer ones, or became too old to be sent.</param>
        internal PublisherQueue(QueueBound bound, Drops drops) =>
            (_bound, _drops) = (bound, drops);

        /// <summary>Whether it stands in the outbox's queue. The outbox's own mark, under its lock.</summary>
        internal bool IsReady { get; set; }

        /// <summary>An empty frame to write into, to be handed back by one of the methods below.</summary>
        internal JsonWriter Rent()
        {
            lock (_waiting)
            {
                JsonWriter frame = _free.Count > 0 ? _free.Pop() : new JsonWriter();
                frame.Clear();
                return frame;
            }
        }

        internal void Add(JsonWriter frame, bool evenLate)
        {
            lock (_waiting)
            {
                _waiting.Enqueue(frame);
                _bound.Add(frame.Count);
                while (_bound.IsExceeded)
                {
                    DropOldest();
                }
                _keepsNewest = evenLate;
            }
        }

        /// <summary>Adds the publisher's own end.</summary>
        internal void AddLast(JsonWriter frame)
        {
            lock (_waiting)
            {
                _last = frame;
            }
        }

        /// <summary>The oldest frame that waits. Null if none does.</summary>
        internal JsonWriter Take()
        {
            lock (_waiting)
            {
                if (_waiting.Count > 0)
                {
                    JsonWriter oldest = _waiting.Dequeue();
                    _bound.Remove(oldest.Count);
                    return oldest;
                }
                JsonWriter last = _last;
                _last = null;
                return last;
            }
        }

        internal void GiveBack(JsonWriter frame)
        {
            lock (_waiting)
            {
                _free.Push(frame);
            }
        }

        /// <summary>Drops the queue, except messages that may be late and the publisher's end.</summary>
        internal void Drop()
        {
            lock (_waiting)
            {
                int kept = _keepsNewest ? 1 : 0;
                while (_waiting.Count > kept)
                {
                    DropOldest();
                }
            }
        }

        /// <summary>Drops all: the connection is gone, and with it what would have ended.</summary>
        internal void Clear()
        {
            lock (_waiting)
            {
                _keepsNewest = false;
                Drop();
                _last = null;
            }
        }

        private void DropOldest()
        {
            JsonWriter oldest = _waiting.Dequeue();
            _bound.Remove(oldest.Count);
            _free.Push(oldest);
            _drops.Add();
        }
    }
}
