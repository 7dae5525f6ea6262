// SPDX-License-Identifier: Apache-2.0
using System;
using System.Threading;
using System.Threading.Tasks;

namespace Ros2Gateway
{
    /// <summary>A reply as a task. It ends in the pump, so what awaits it goes on there.</summary>
    internal sealed class AwaitedReply<T> : IAwaited
    {
        private readonly AwaitedTasks _all;
        private readonly string _what;
        private readonly CancellationToken _cancellation;
        private readonly TaskCompletionSource<T> _source = new();
        private CancellationTokenRegistration _registration;

        /// <param name="what">Its name, for people: "call_service /reset".</param>
        internal AwaitedReply(AwaitedTasks all, string what, CancellationToken cancellation)
        {
            _all = all;
            _what = what;
            _cancellation = cancellation;
            all.Add(this);
        }

        internal Task<T> Task => _source.Task;

        /// <summary>Called when the token is cancelled, on the thread that cancels it.</summary>
        internal void OnCancelled(Action action)
        {
            _registration = _cancellation.Register(action);
            if (_source.Task.IsCompleted)
            {
                _registration.Dispose();
            }
        }

        internal void Answer(Reply<T> reply)
        {
            Leave();
            if (reply.Ok)
            {
                _source.TrySetResult(reply.Value);
            }
            else
            {
                _source.TrySetException(new GatewayException(_what + ": " + reply.Error));
            }
        }

        internal void Cancel()
        {
            Leave();
            _source.TrySetCanceled(_cancellation);
        }

        public void Abandon(string errorText)
        {
            if (_cancellation.IsCancellationRequested)
            {
                Cancel();
            }
            else
            {
                Answer(Reply<T>.Failed(errorText));
            }
        }

        private void Leave()
        {
            _all.Remove(this);
            _registration.Dispose();
        }
    }
}
