// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Diagnostics;
using System.Threading.Tasks;

namespace Ros2Gateway
{
    /// <summary>The queue for the application's thread: answers, events, and subscriptions with messages.</summary>
    internal sealed class Mailbox
    {
        // Screenfuls of log. More than this between two frames of the application is one fault repeated.
        private const int MaxEvents = 256;

        // More names of actions that throw than this are forgotten together, and counted again: one fault repeated.
        private const int MaxFaulty = 256;

        private readonly object _gate = new();
        private readonly Queue<(string What, Action Action)> _actions = new(); // bounded by what was asked for
        private readonly Queue<GatewayEvent> _events = new();
        private readonly Queue<Subscription> _ready = new();
        private readonly Dictionary<string, long> _faults = new(); // of actions, by name
        private readonly Stopwatch _watch = new();
        private int _droppedEvents;
        private bool _isPumping;
        private volatile bool _wasPumped;
        private bool _isClosed;
        private volatile int _frame;
        private TaskCompletionSource<bool> _arrival; // awaited by RunAsync

        internal Mailbox() => Heard = new Listeners<GatewayEvent>(ReportFault, "listener of events");

        /// <summary>Called while pumping, for each event.</summary>
        internal Listeners<GatewayEvent> Heard { get; private set; }

        /// <summary>Another number with each time that the application pumps.</summary>
        internal int Frame => _frame;

        /// <summary>Has an action done by the next pump.</summary>
        /// <param name="what">Its name, for people: "call_service /reset".</param>
        internal void Post(string what, Action action)
        {
            lock (_gate)
            {
                if (!_isClosed)
                {
                    _actions.Enqueue((what, action));
                    Arrived();
                }
            }
        }

        internal void Report(GatewayEvent happened)
        {
            lock (_gate)
            {
                if (_isClosed)
                {
                    return;
                }
                if (_events.Count >= MaxEvents)
                {
                    _events.Dequeue();
                    _droppedEvents++;
                }
                _events.Enqueue(happened);
                Arrived();
            }
        }

        /// <summary>
        /// Tells that a handler of the application's has thrown: the first time, and the 10th, 100th ... time.
        /// </summary>
        /// <param name="where">The handler, for people: "handler of /odom".</param>
        internal void ReportFault(string where, Exception error, long times)
        {
            GatewayEvent fault = Faults.Event(where, error, times);
            if (fault != null)
            {
                Report(fault);
            }
        }

        /// <summary>A subscription has messages for its handler. Once until it has none.</summary>
        internal void Ready(Subscription subscription)
        {
            lock (_gate)
            {
                if (!_isClosed)
                {
                    _ready.Enqueue(subscription);
                    Arrived();
                }
            }
        }

        /// <summary>Ends when something waits for the pump, or after so long.</summary>
        internal Task WaitAsync(int milliseconds)
        {
            lock (_gate)
            {
                if (_actions.Count + _events.Count + _ready.Count > 0)
                {
                    return Task.CompletedTask;
                }
                _arrival = new TaskCompletionSource<bool>(TaskCreationOptions.RunContinuationsAsynchronously);
                return Task.WhenAny(_arrival.Task, Task.Delay(milliseconds));
            }
        }

        private void Arrived()
        {
            _arrival?.TrySetResult(true);
            _arrival = null;
        }

        /// <summary>Whether anybody has ever pumped.</summary>
        internal bool WasPumped => _wasPumped;

        /// <summary>
        /// Calls handlers until nothing waits or the time is up. Returns how many messages were handed out.
        /// A handler that pumps gets nothing.
        /// </summary>
        internal int Pump(double budgetMilliseconds)
        {
            if (_isPumping)
            {
                return 0;
            }
            _isPumping = true;
            _wasPumped = true;
            _frame++;
            try
            {
                return PumpOnce(budgetMilliseconds);
            }
            finally
            {
                _isPumping = false;
            }
        }

        /// <summary>Forgets all that waits. Nothing is called from now on.</summary>
        internal void Close()
        {
            lock (_gate)
            {
                _isClosed = true;
                _actions.Clear();
                _events.Clear();
                _ready.Clear();
            }
        }

        private int PumpOnce(double budgetMilliseconds)
        {
            _watch.Restart();
            // Messages that arrive while handlers run wait for the next time: no handler can keep us here forever.
            int actions;
            int events;
            lock (_gate)
            {
                actions = _actions.Count;
                events = _events.Count;
            }
            for (; actions > 0; actions--)
            {
                Act();
            }
            for (; events > 0; events--)
            {
                HearOne();
            }
            int messages = 0;
            do
            {
                Subscription subscription = Next();
                if (subscription == null)
                {
                    break;
                }
                try
                {
                    if (subscription.HandOut())
                    {
                        messages++;
                        Ready(subscription);
                    }
                }
                catch (Exception error)
                {
                    Ready(subscription);
                    subscription.HandlerFaults++;
                    ReportFault("handler of " + subscription.Topic, error, subscription.HandlerFaults);
                }
            }
            while (_watch.Elapsed.TotalMilliseconds < budgetMilliseconds);
            return messages;
        }

        private Subscription Next()
        {
            lock (_gate)
            {
                return _ready.Count > 0 ? _ready.Dequeue() : null;
            }
        }

        private void Act()
        {
            (string What, Action Action) posted;
            lock (_gate)
            {
                if (_actions.Count == 0)
                {
                    return; // a handler has closed everything
                }
                posted = _actions.Dequeue();
            }
            try
            {
                posted.Action();
            }
            catch (Exception error)
            {
                // A fault of one handler of the application must not keep the others from their messages.
                ReportFault("handler of " + posted.What, error, CountFault(posted.What + error.GetType().Name));
            }
        }

        private long CountFault(string what)
        {
            if (!_faults.TryGetValue(what, out long before) && _faults.Count >= MaxFaulty)
            {
                _faults.Clear();
            }
            _faults[what] = before + 1;
            return before + 1;
        }

        private void HearOne()
        {
            GatewayEvent happened;
            int dropped;
            lock (_gate)
            {
                if (_events.Count == 0)
                {
                    return;
                }
                happened = _events.Dequeue();
                dropped = _droppedEvents;
                _droppedEvents = 0;
            }
            if (dropped > 0)
            {
                Heard.Call(new GatewayEvent(EventLevel.Warning, dropped + " events were dropped", "client", ""));
            }
            Heard.Call(happened);
        }
    }
}
