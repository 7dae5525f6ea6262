// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway
{
    /// <summary>The state of one topic that may move a robot, and its listeners in this client.</summary>
    internal sealed class ControlTopic
    {
        private const string NotKnown = "not known yet who drives";

        private readonly object _gate = new object();
        private readonly Mailbox _mailbox;
        private volatile ControlState _state;
        private readonly Listeners<ControlState> _watchers;
        private bool _isPosted;

        internal ControlTopic(string name, Mailbox mailbox)
        {
            Name = name;
            Id = "control:" + name;
            _mailbox = mailbox;
            _watchers = new Listeners<ControlState>(mailbox.ReportFault, "listener of who drives " + name);
            _state = new ControlState(name, NotKnown);
        }

        internal string Name { get; private set; }

        /// <summary>Of the operation that asks for the state.</summary>
        internal string Id { get; private set; }

        /// <summary>Publishers and controls that use it. Under the lock of all.</summary>
        internal int Users { get; set; }

        /// <summary>Whether this connection has asked for control and has had it since. Under the lock of all.</summary>
        internal bool IsAskedFor { get; set; }

        /// <summary>Until when control that a lost connection had is taken back. Under the lock of all.</summary>
        internal long TakeBackUntil { get; set; }

        /// <summary>Whether the gateway has ever said that it moves a robot.</summary>
        internal bool MovesARobot { get; private set; }

        /// <summary>The newest. Another object with every word of the gateway.</summary>
        internal ControlState State
        {
            get { return _state; }
        }

        internal FaultReport ReportFault
        {
            get { return _mailbox.ReportFault; }
        }

        internal void Add(Action<ControlState> watcher)
        {
            _watchers.Add(watcher);
            if (_state.IsKnown)
            {
                Post();
            }
        }

        internal void Remove(Action<ControlState> watcher)
        {
            _watchers.Remove(watcher);
        }

        internal void Set(ControlState state)
        {
            MovesARobot |= state.IsKnown;
            _state = state;
            Post();
        }

        /// <summary>The connection is gone, and what was known with it.</summary>
        internal void Forget()
        {
            Set(new ControlState(Name, "not connected"));
        }

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
            _mailbox.Post("who drives", Tell);
        }

        private void Tell()
        {
            lock (_gate)
            {
                _isPosted = false;
            }
            _watchers.Call(_state);
        }
    }
}
