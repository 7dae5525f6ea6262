// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;

namespace Ros2Gateway
{
    /// <summary>Something that the application awaits.</summary>
    internal interface IAwaited
    {
        /// <summary>Nothing will come any more: ends it, with the reason, unless it has ended.</summary>
        void Abandon(string errorText);
    }

    /// <summary>The awaited tasks of a client, so that they end with the client. Any thread.</summary>
    internal sealed class AwaitedTasks
    {
        private const string Closed = "the client was disposed";

        private readonly HashSet<IAwaited> _open = new(); // bounded as requests and goals are
        private bool _isClosed;

        /// <summary>Keeps it until it is removed. Of a client that has ended it is abandoned at once.</summary>
        internal void Add(IAwaited awaited)
        {
            lock (_open)
            {
                if (!_isClosed)
                {
                    _open.Add(awaited);
                    return;
                }
            }
            awaited.Abandon(Closed);
        }

        internal void Remove(IAwaited awaited)
        {
            lock (_open)
            {
                _open.Remove(awaited);
            }
        }

        /// <summary>Whether anything waits.</summary>
        internal bool IsAny
        {
            get
            {
                lock (_open)
                {
                    return _open.Count > 0;
                }
            }
        }

        internal void Close()
        {
            lock (_open)
            {
                _isClosed = true;
            }
            Abandon(Closed);
        }

        /// <summary>Ends all that waits, with the reason.</summary>
        internal void Abandon(string errorText)
        {
            List<IAwaited> all;
            lock (_open)
            {
                all = new List<IAwaited>(_open);
                _open.Clear();
            }
            foreach (IAwaited awaited in all)
            {
                awaited.Abandon(errorText);
            }
        }
    }
}
