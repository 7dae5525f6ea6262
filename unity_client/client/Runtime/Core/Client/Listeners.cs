// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway
{
    /// <summary>
    /// Those who listen to something, called one after the other. One that throws harms no other, and is told
    /// once, and again at its 10th, 100th ... time, with the count.
    /// </summary>
    /// <remarks>Added and removed on any thread, called on one at a time. Calling allocates nothing.</remarks>
    internal sealed class Listeners<T>
    {
        private readonly object _gate = new();
        private readonly FaultReport _report;
        private readonly string _what;
        private volatile Listener[] _all = new Listener[0]; // replaced, never changed
        private Listener _last; // null without one

        /// <param name="what">Their name, for people: "listener of events".</param>
        internal Listeners(FaultReport report, string what) =>
            (_report, _what) = (report, what);

        /// <summary>Whether nothing was added.</summary>
        internal bool IsEmpty => _all.Length == 0;

        /// <summary>Adds one. Returns whether it is the first.</summary>
        internal bool Add(Action<T> listener) => listener != null && Add(new Listener(_what, listener, listener));

        /// <summary>Adds one that only wants to know when. Returns whether it is the first.</summary>
        internal bool Add(Action listener) => listener != null && Add(new Listener(_what, listener, value => listener()));

        /// <summary>Sets what is called after all that are added: the list of the Inspector.</summary>
        /// <param name="what">Its name, for people: "listener of On Message".</param>
        internal void SetLast(string what, Action<T> listener) => _last = new Listener(what, listener, listener);

        /// <summary>Removes one, the last of several that are equal. Returns whether it was the only one.</summary>
        internal bool Remove(Delegate listener)
        {
            lock (_gate)
            {
                int at = Array.FindLastIndex(_all, one => one.Added == listener);
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
                Call(all[i], value);
            }
            if (_last != null)
            {
                Call(_last, value);
            }
        }

        private bool Add(Listener listener)
        {
            lock (_gate)
            {
                Listener[] after = new Listener[_all.Length + 1];
                _all.CopyTo(after, 0);
                after[_all.Length] = listener;
                _all = after;
                return after.Length == 1;
            }
        }

        private void Call(Listener listener, T value)
        {
            try
            {
                listener.Call(value);
            }
            catch (Exception error)
            {
                listener.Faults++;
                _report(listener.What, error, listener.Faults);
            }
        }

        private sealed class Listener
        {
            internal readonly string What;
            internal readonly Delegate Added;
            internal readonly Action<T> Call;
            internal long Faults;

            internal Listener(string what, Delegate added, Action<T> call) =>
                (What, Added, Call) = (what, added, call);
        }
    }
}
