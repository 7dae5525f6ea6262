// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway
{
    /// <summary>The state of one topic that may move a robot, and its listeners in this client.</summary>
    internal sealed class ControlTopic
    {
        // A refusal without a known end is asked for again after so long: soon enough not to miss a deadline.
        private const int AskAgainMilliseconds = 250;

        // A change of state tells when a stop is reset. If that was lost on the way, this ends the waiting.
        private const int ResetMilliseconds = 300;

        private const string NotKnown = "not known yet who drives";

        private readonly object _gate = new();
        private readonly GatewayClient _client;
        private volatile ControlState _state;
        private readonly Listeners<ControlState> _watchers;
        private volatile Refused _refused;
        private bool _isPosted;

        internal ControlTopic(string name, GatewayClient client)
        {
            Name = name;
            Id = "control:" + name;
            _client = client;
            _watchers = new Listeners<ControlState>(client.Mailbox.ReportFault, "listener of who drives " + name);
            _state = new ControlState(name, NotKnown);
        }

        internal string Name { get; private set; }

        /// <summary>Of the operation that asks for the state.</summary>
        internal string Id { get; private set; }

        /// <summary>Controls that use it. Under the lock of all.</summary>
        internal int Users { get; set; }

        /// <summary>Whether this connection has asked for control and has had it since. Under the lock of all.</summary>
        internal bool IsAskedFor { get; set; }

        /// <summary>Until when control that a lost connection had is taken back. Under the lock of all.</summary>
        internal long TakeBackUntil { get; set; }

        /// <summary>The newest. Another object with every word of the gateway.</summary>
        internal ControlState State => _state;

        /// <summary>Why a command to move would be refused, or null.</summary>
        internal string Refusal
        {
            get
            {
                // The last word counts: a state that came after the refusal knows better.
                ControlState state = _state;
                Refused refused = _refused;
                return state.Refusal ?? (refused != null && refused.State == state && _client.Clock.Now < refused.Until
                    ? refused.Reason : null);
            }
        }

        internal FaultReport ReportFault => _client.Mailbox.ReportFault;

        internal void Add(Action<ControlState> watcher)
        {
            _watchers.Add(watcher);
            if (_state.IsKnown)
            {
                Post();
            }
        }

        internal void Remove(Action<ControlState> watcher) => _watchers.Remove(watcher);

        internal void Set(ControlState state)
        {
            _state = state;
            Post();
        }

        /// <summary>The gateway has refused a message. Returns whether that refuses those after it.</summary>
        internal bool OnRefused(string code, string reason)
        {
            ControlState state = _state;
            bool lasts = code == "tripped" || code == "not_lease_holder" || code == "stale_command" || code == "forbidden"
                || (code == "invalid_value" && state.IsKnown); // elsewhere the next message may be right
            if (lasts)
            {
                bool isEndTold = code == "tripped" && state.IsKnown;
                _refused = new Refused(
                    reason, isEndTold ? long.MaxValue : _client.Clock.Now + AskAgainMilliseconds, state);
            }
            return lasts;
        }

        /// <summary>A zero goes, which may end what was refused.</summary>
        internal void OnZero()
        {
            Refused refused = _refused;
            if (refused != null && refused.Until == long.MaxValue)
            {
                _refused = new Refused(refused.Reason, _client.Clock.Now + ResetMilliseconds, refused.State);
            }
        }

        /// <summary>The connection is gone, and what was known with it.</summary>
        internal void Forget() => Set(new ControlState(Name, "not connected"));

        // Only the newest state matters, so one word in the mailbox is enough.
        private void Post()
        {
            lock (_gate)
            {
                if (_isPosted || _watchers.IsEmpty)
                {
                    return;
                }
                _isPosted = true;
            }
            _client.Mailbox.Post("who drives", Tell);
        }

        private void Tell()
        {
            lock (_gate)
            {
                _isPosted = false;
            }
            _watchers.Call(_state);
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
}
