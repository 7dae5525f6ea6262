// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Threading;

namespace UnityEngine.Stage
{
    /// <summary>The queue of continuations for the next frame, as in Unity: a caller that blocks the main thread on a
    /// task that continues there waits forever.</summary>
    internal sealed class FrameSynchronizationContext : SynchronizationContext
    {
        private readonly Queue<KeyValuePair<SendOrPostCallback, object>> _posted =
            new Queue<KeyValuePair<SendOrPostCallback, object>>();
        private readonly Thread _thread = Thread.CurrentThread;

        public override void Post(SendOrPostCallback callback, object state)
        {
            lock (_posted)
            {
                _posted.Enqueue(new KeyValuePair<SendOrPostCallback, object>(callback, state));
            }
        }

        public override void Send(SendOrPostCallback callback, object state)
        {
            if (Thread.CurrentThread == _thread)
            {
                callback(state);
                return;
            }
            using (var done = new ManualResetEventSlim())
            {
                Post(ignored =>
                {
                    callback(state);
                    done.Set();
                }, null);
                done.Wait();
            }
        }

        public override SynchronizationContext CreateCopy()
        {
            return this;
        }

        public void RunPosted()
        {
            int count;
            lock (_posted)
            {
                count = _posted.Count;  // their posts wait for the next frame
            }
            for (int i = 0; i < count; i++)
            {
                KeyValuePair<SendOrPostCallback, object> next;
                lock (_posted)
                {
                    next = _posted.Dequeue();
                }
                try
                {
                    next.Key(next.Value);
                }
                catch (Exception exception)
                {
                    Debug.LogException(exception);
                }
            }
        }
    }
}
