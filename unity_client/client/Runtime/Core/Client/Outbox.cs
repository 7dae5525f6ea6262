// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Diagnostics;
using System.Threading;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>The queue for the network: requests in order, and a short queue per publisher.</summary>
    /// <remarks>
    /// One frame at a time is with the transport, so what else waits can still be dropped for something
    /// newer. Requests go first. Queues take turns. Frames in the transport may wait on in the system's
    /// buffers, where nothing can be dropped. So queues are held while the gateway leaves a ping unanswered,
    /// or a robot would carry out seconds of commands at once when a network comes back. Any thread.
    /// </remarks>
    internal sealed class Outbox
    {
        // Requests are few and small. This many waiting means that nothing is leaving any more.
        private const int MaxRequests = 1024;

        // How often to ping while publishers are busy: twice within the time after which queues are held.
        private const int BusyPingMilliseconds = 250;

        /// <summary>The refusal while there is no connection.</summary>
        internal const string NotConnected = "not connected";
        private const long Never = -1;

        private readonly object _gate = new();
        private readonly Clock _clock;
        private readonly int _freshMilliseconds;
        private readonly Queue<JsonWriter> _requests = new();
        private readonly Stack<JsonWriter> _spare = new();
        private readonly Queue<PublisherQueue> _ready = new();
        private ITransport _transport;
        private bool _areQueuesOpen;
        private JsonWriter _next; // offered to the transport, or with it
        private PublisherQueue _nextQueue; // the queue that it came from. Null for a request
        private bool _isSending;
        private bool _isFlushing;
        private long _unansweredSince = Never; // when the first ping left that no pong has followed
        private long _lastPing;
        private bool _areQueuesBusy; // since the last ping

        internal Outbox(Clock clock, int freshMilliseconds)
        {
            _clock = clock;
            _freshMilliseconds = freshMilliseconds;
            MaxFrameBytes = int.MaxValue;
        }

        /// <summary>The largest frame for the gateway, which closes a connection that sends more.</summary>
        internal int MaxFrameBytes { get; set; }

        /// <summary>From now on requests go here. The queue for another transport is gone.</summary>
        internal void Attach(ITransport transport)
        {
            lock (_gate)
            {
                Clear();
                _transport = transport;
            }
        }

        /// <summary>Lets publishers send: what they are for has been advertised.</summary>
        internal void OpenQueues()
        {
            lock (_gate)
            {
                _areQueuesOpen = _transport != null;
            }
        }

        /// <summary>Nothing goes anywhere. The queue is dropped.</summary>
        internal void Detach()
        {
            lock (_gate)
            {
                Clear();
                _transport = null;
                Monitor.PulseAll(_gate);
            }
        }

        /// <summary>Sends a request. Returns why it does not go, or null.</summary>
        /// <param name="write">Writes the members after op and id.</param>
        internal string Send(string op, string id = null, Action<JsonWriter> write = null)
        {
            JsonWriter frame = Rent();
            frame.Begin(op, id);
            write?.Invoke(frame);
            frame.EndObject();
            return Post(frame);
        }

        /// <summary>An empty frame to write a request into, for <see cref="Post(JsonWriter)"/>.</summary>
        internal JsonWriter Rent()
        {
            lock (_gate)
            {
                JsonWriter frame = _spare.Count > 0 ? _spare.Pop() : new JsonWriter();
                frame.Clear();
                return frame;
            }
        }

        /// <summary>Sends a request. Returns why it does not go, or null.</summary>
        internal string Post(JsonWriter frame)
        {
            lock (_gate)
            {
                string refusal = _transport == null ? NotConnected
                    : _requests.Count >= MaxRequests ? "at most " + MaxRequests + " requests wait to be sent"
                    : TooLarge(frame);
                if (refusal != null)
                {
                    _spare.Push(frame);
                    return refusal;
                }
                _requests.Enqueue(frame);
            }
            Flush();
            return null;
        }

        /// <summary>Sends a frame of a queue when its turn comes. Returns why it does not go, or null.</summary>
        internal string Post(PublisherQueue queue, JsonWriter frame, bool evenLate)
        {
            lock (_gate)
            {
                string refusal = !_areQueuesOpen ? NotConnected
                    : !evenLate && AreQueuesHeld() ? "no answer from the gateway for " + _freshMilliseconds + " ms"
                    : TooLarge(frame);
                if (refusal != null)
                {
                    queue.GiveBack(frame);
                    return refusal;
                }
                queue.Add(frame, evenLate);
                Enqueue(queue);
            }
            Flush();
            return null;
        }

        /// <summary>Sends a publisher's own end, after what its queue holds.</summary>
        internal void PostLast(PublisherQueue queue, JsonWriter frame)
        {
            lock (_gate)
            {
                if (_transport == null)
                {
                    return; // it has ended with the connection
                }
                queue.AddLast(frame);
                Enqueue(queue);
            }
            Flush();
        }

        /// <summary>Whether it is time for a ping out of turn: publishers are busy.</summary>
        internal bool IsPingDue(long now)
        {
            lock (_gate)
            {
                return _areQueuesBusy && now - _lastPing >= BusyPingMilliseconds;
            }
        }

        internal void OnPing(long now)
        {
            lock (_gate)
            {
                _lastPing = now;
                _areQueuesBusy = false;
                if (_unansweredSince == Never)
                {
                    _unansweredSince = now;
                }
            }
        }

        internal void OnPong()
        {
            lock (_gate)
            {
                _unansweredSince = Never;
            }
        }

        /// <summary>Hands frames to the transport until it is busy or nothing waits.</summary>
        internal void Flush()
        {
            lock (_gate)
            {
                if (_isFlushing)
                {
                    return; // a transport that has sent at once calls back into here
                }
                _isFlushing = true;
                try
                {
                    while (_transport != null && !_isSending && TakeNext())
                    {
                        _isSending = true;
                        if (!_transport.TrySend(_next.Buffer, _next.Count))
                        {
                            _isSending = false;
                            break;
                        }
                    }
                }
                finally
                {
                    _isFlushing = false;
                }
            }
        }

        /// <summary>The frame that was with *transport* has left.</summary>
        internal void OnSent(ITransport transport)
        {
            lock (_gate)
            {
                if (transport != _transport || !_isSending)
                {
                    return;
                }
                GiveBack();
                _isSending = false;
                Flush();
                Monitor.PulseAll(_gate);
            }
        }

        /// <summary>Waits until all has left, at most so long: the last word may be a robot's stop.</summary>
        internal void WaitUntilEmpty(int milliseconds)
        {
            Stopwatch watch = Stopwatch.StartNew();
            lock (_gate)
            {
                while (_transport != null && (_next != null || _requests.Count > 0 || _ready.Count > 0))
                {
                    int left = milliseconds - (int)watch.ElapsedMilliseconds;
                    if (left <= 0 || !Monitor.Wait(_gate, left))
                    {
                        return;
                    }
                }
            }
        }

        private string TooLarge(JsonWriter frame) =>
            frame.Count <= MaxFrameBytes ? null
                : "a frame of " + frame.Count + " bytes, the gateway takes at most " + MaxFrameBytes;

        private bool AreQueuesHeld() => _unansweredSince != Never && _clock.Now - _unansweredSince > _freshMilliseconds;

        private void Enqueue(PublisherQueue queue)
        {
            _areQueuesBusy = true;
            if (!queue.IsReady)
            {
                queue.IsReady = true;
                _ready.Enqueue(queue);
            }
        }

        private bool TakeNext()
        {
            if (_next != null)
            {
                return true;
            }
            if (_requests.Count > 0)
            {
                _next = _requests.Dequeue();
                return true;
            }
            bool areHeld = AreQueuesHeld();
            while (_ready.Count > 0)
            {
                PublisherQueue queue = _ready.Dequeue();
                if (areHeld)
                {
                    queue.Drop(); // it was meant for a moment that has passed
                }
                _next = queue.Take();
                if (_next == null)
                {
                    queue.IsReady = false;
                    continue;
                }
                _nextQueue = queue;
                _ready.Enqueue(queue);
                return true;
            }
            return false;
        }

        private void GiveBack()
        {
            if (_next == null)
            {
                return;
            }
            if (_nextQueue != null)
            {
                _nextQueue.GiveBack(_next);
            }
            else
            {
                _spare.Push(_next);
            }
            _next = null;
            _nextQueue = null;
        }

        private void Clear()
        {
            _areQueuesOpen = false;
            _areQueuesBusy = false;
            _unansweredSince = Never;
            if (_isSending)
            {
                // An abandoned transport may read these bytes yet: let it have them.
                _next = null;
                _nextQueue = null;
                _isSending = false;
            }
            GiveBack();
            while (_requests.Count > 0)
            {
                _spare.Push(_requests.Dequeue());
            }
            while (_ready.Count > 0)
            {
                PublisherQueue queue = _ready.Dequeue();
                queue.IsReady = false;
                queue.Clear();
            }
        }
    }
}
