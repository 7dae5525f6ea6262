// SPDX-License-Identifier: Apache-2.0
using System;
using System.Runtime.CompilerServices;
using System.Threading;
using System.Threading.Tasks;

namespace Ros2Gateway
{
    /// <summary>A goal to await: its feedback one after the other, and its result.</summary>
    /// <remarks>
    /// <c>await</c> it for the result. Before that, <c>await foreach</c> over it (C# 8), or call
    /// <see cref="MoveNextAsync"/> until it is false, for the feedback. A goal that ended as succeeded, canceled
    /// or aborted has a result. Without one (rejected, the connection lost) a <see cref="GatewayException"/> says
    /// why, to both. If its token was cancelled and the goal ended early, both throw OperationCanceledException.
    /// </remarks>
    public sealed class GoalTask<TFeedback, TResult> : IAwaited
        where TFeedback : IMessage, new()
        where TResult : IMessage, new()
    {
        private readonly object _gate = new();
        private readonly AwaitedTasks _all;
        private readonly string _action;
        private readonly CancellationToken _cancellation;
        private readonly TaskCompletionSource<GoalResult<TResult>> _end = new();
        private CancellationTokenRegistration _registration;
        private Goal _goal; // null if it was cancelled before it was sent
        private TaskCompletionSource<bool> _next; // of who waits for feedback
        private TFeedback _feedback; // the newest. It replaces unread feedback
        private bool _hasFeedback;

        internal GoalTask(AwaitedTasks all, string action, CancellationToken cancellation)
        {
            _all = all;
            _action = action;
            _cancellation = cancellation;
            if (cancellation.IsCancellationRequested)
            {
                Cancelled();
            }
            else
            {
                all.Add(this);
            }
        }

        /// <summary>The feedback that <see cref="MoveNextAsync"/> has come to.</summary>
        public TFeedback Current { get; private set; }

        /// <summary>How the goal stands.</summary>
        public GoalStatus Status => _goal?.Status ?? GoalStatus.Unknown;

        /// <summary>The result as a task, for Task.WhenAll and its like.</summary>
        public Task<GoalResult<TResult>> Result => _end.Task;

        /// <summary>Makes it something to await.</summary>
        public TaskAwaiter<GoalResult<TResult>> GetAwaiter() => _end.Task.GetAwaiter();

        /// <summary>Waits for feedback that has not been seen. False once the goal has ended with a result.</summary>
        /// <exception cref="InvalidOperationException">Someone else waits already.</exception>
        public Task<bool> MoveNextAsync()
        {
            lock (_gate)
            {
                if (_next != null)
                {
                    throw new InvalidOperationException("feedback of " + _action + " is awaited already");
                }
                if (_hasFeedback)
                {
                    _hasFeedback = false;
                    Current = _feedback;
                    return Task.FromResult(true);
                }
                TaskCompletionSource<bool> next = new();
                if (_end.Task.IsCompleted)
                {
                    EndOf(next);
                }
                else
                {
                    _next = next;
                }
                return next.Task;
            }
        }

        /// <summary>
        /// Makes it something for <c>await foreach</c>, which C# finds by its name. The token of SendGoalAsync ends it.
        /// </summary>
        public GoalTask<TFeedback, TResult> GetAsyncEnumerator() => this;

        /// <summary>Asks for the goal to be cancelled. Whether it was, the result's status tells.</summary>
        public void Cancel() => _goal?.Cancel();

        void IAwaited.Abandon(string errorText) =>
            OnResult(new GoalResult<TResult>(GoalStatus.Unknown, default(TResult), errorText));

        /// <summary>The goal was sent.</summary>
        internal void Follow(Goal goal)
        {
            _goal = goal;
            _registration = _cancellation.Register(Cancel);
            if (_end.Task.IsCompleted)
            {
                _registration.Dispose();
            }
        }

        internal void OnFeedback(TFeedback feedback)
        {
            TaskCompletionSource<bool> next;
            lock (_gate)
            {
                next = _next;
                _next = null;
                if (next == null)
                {
                    _feedback = feedback;
                    _hasFeedback = true;
                    return;
                }
                Current = feedback;
            }
            next.TrySetResult(true);
        }

        internal void OnResult(GoalResult<TResult> result)
        {
            _all.Remove(this);
            _registration.Dispose();
            bool isCancelled = _cancellation.IsCancellationRequested
                && (result.Error != null || result.Status == GoalStatus.Canceled);
            if (isCancelled)
            {
                Cancelled();
            }
            else if (result.Error != null)
            {
                _end.TrySetException(new GatewayException("goal of " + _action + ": " + result.Error));
            }
            else
            {
                _end.TrySetResult(result);
            }
            TaskCompletionSource<bool> next;
            lock (_gate)
            {
                next = _next;
                _next = null;
            }
            if (next != null)
            {
                EndOf(next);
            }
        }

        private void Cancelled() => _end.TrySetCanceled(_cancellation);

        // A caller that reads the feedback must not miss that there is no result.
        private void EndOf(TaskCompletionSource<bool> next)
        {
            if (_end.Task.IsCanceled)
            {
                next.TrySetCanceled(_cancellation);
            }
            else if (_end.Task.IsFaulted)
            {
                next.TrySetException(_end.Task.Exception.InnerException);
            }
            else
            {
                next.TrySetResult(false);
            }
        }
    }
}
