// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway
{
    /// <summary>Takes note of an exception of a handler of the application's, and how many it has thrown by now.</summary>
    internal delegate void FaultReport(string where, Exception error, long times);

    /// <summary>
    /// Those who listen to something, called one after the other. One that throws harms no other, and is told
    /// once, and again at its 10th, 100th ... time, with the count.
    /// </summary>
    /// <remarks>Added and removed on any thread, called on the application's own. Calling allocates nothing.</remarks>
    internal sealed class Listeners<T>
    {
        private readonly object _gate = new object();
        private readonly FaultReport _report;
        private readonly string _what;
        private volatile Listener[] _all = new Listener[0]; // replaced, never changed

        /// <param name="what">What they are, for people: "listener of events".</param>
        internal Listeners(FaultReport report, string what)
        {
            _report = report;
            _what = what;
        }

        internal bool IsEmpty
        {
            get { return _all.Length == 0; }
        }

        /// <summary>Adds one; returns whether it is the first.</summary>
        internal bool Add(Action<T> listener)
        {
            if (listener == null)
            {
                return false;
            }
            lock (_gate)
            {
                Listener[] after = new Listener[_all.Length + 1];
                _all.CopyTo(after, 0);
                after[_all.Length] = new Listener(listener);
                _all = after;
                return after.Length == 1;
            }
        }

        /// <summary>Removes one, the last of several that are equal; returns whether it was the only one.</summary>
        internal bool Remove(Action<T> listener)
        {
            lock (_gate)
            {
                int at = Array.FindLastIndex(_all, one => one.Call == listener);
                if (at < 0)
                {
                    return false;
                }
                Listener[] after = new Listener[_all.Length - 1];
                Array.Copy(_all, after, at);
                Array.Copy(_all, at + 1, after, at, after.Length - at);
                _all = after;
                return after.Length == 0;
            }
        }

        internal void Call(T value)
        {
            Listener[] all = _all;
            for (int i = 0; i < all.Length; i++)
            {
                try
                {
                    all[i].Call(value);
                }
                catch (Exception error)
                {
                    all[i].Faults++;
                    _report(_what, error, all[i].Faults);
                }
            }
        }

        private sealed class Listener
        {
            internal readonly Action<T> Call;
            internal long Faults;

            internal Listener(Action<T> call)
            {
                Call = call;
            }
        }
    }
}
