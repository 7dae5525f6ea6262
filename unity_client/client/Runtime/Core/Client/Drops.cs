// SPDX-License-Identifier: Apache-2.0
using System;
using System.Threading;

namespace Ros2Gateway
{
    /// <summary>
    /// Counts what a queue drops, and tells it: listeners in the next <see cref="Mailbox.Pump"/>, people by an event
    /// now and then. Of a queue that keeps the newest alone, dropping is not news for people.
    /// </summary>
    internal sealed class Drops
    {
        // Between two events about one queue: one that drops at 60 Hz is one piece of news.
        private const long RepeatMilliseconds = 5000;

        private readonly GatewayClient _client;
        private readonly Listeners<long> _listeners;
        private readonly Action _tell;
        private readonly string _request;
        private readonly string _topic;
        private readonly string _reason;
        private long _count;
        private long _toldCount;
        private long _nextTold;
        private int _isPosted;

        /// <param name="request">The operation that they belong to: "publish" or "subscribe".</param>
        /// <param name="reason">Why, and what to do. Empty where it is not news for people.</param>
        internal Drops(GatewayClient client, string request, string topic, string reason)
        {
            _client = client;
            _request = request;
            _topic = topic;
            _reason = reason;
            _listeners = new Listeners<long>(client.Mailbox.ReportFault, "listener of DroppedChanged of " + topic);
            _tell = Tell;
        }

        internal long Count => Interlocked.Read(ref _count);

        /// <summary>They get <see cref="Count"/> when it is another.</summary>
        internal Listeners<long> Listeners => _listeners;

        /// <summary>One more. Any thread.</summary>
        internal void Add()
        {
            Interlocked.Increment(ref _count);
            bool isHeard = _reason.Length > 0 || !_listeners.IsEmpty;
            if (isHeard && Interlocked.Exchange(ref _isPosted, 1) == 0)
            {
                _client.Mailbox.Post("DroppedChanged", _tell);
            }
        }

        private void Tell()
        {
            Interlocked.Exchange(ref _isPosted, 0);
            long count = Count;
            if (_reason.Length > 0 && _client.Clock.Now >= _nextTold)
            {
                _nextTold = _client.Clock.Now + RepeatMilliseconds;
                long fresh = count - _toldCount;
                _toldCount = count;
                _client.Reports.Tell(
                    EventLevel.Warning,
                    _topic + ": " + (fresh == 1 ? "1 message was" : fresh + " messages were") + " dropped, "
                    + count + " in all: " + _reason,
                    "dropped",
                    _request);
            }
            _listeners.Call(count);
        }
    }
}
