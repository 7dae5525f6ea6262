// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>How a goal stands. The numbers of action_msgs/msg/GoalStatus.</summary>
    public enum GoalStatus
    {
        /// <summary>It was rejected, could not be sent, or its server or the connection is gone.</summary>
        Unknown = 0,

        /// <summary>It was sent. Feedback may come.</summary>
        Executing = 2,

        /// <summary>It was asked to end early.</summary>
        Canceling = 3,

        /// <summary>It was reached.</summary>
        Succeeded = 4,

        /// <summary>It ended early, as asked.</summary>
        Canceled = 5,

        /// <summary>The server gave it up.</summary>
        Aborted = 6,
    }

    /// <summary>A goal that was sent to an action server.</summary>
    public abstract class Goal
    {
        private readonly Goals _goals;
        private readonly object _statusGate = new();

        internal Goal(Goals goals, string id, string action)
        {
            _goals = goals;
            Id = id;
            Action = action;
            ResultName = "the result of " + action;
            FeedbackName = "the feedback of " + action;
            Status = GoalStatus.Executing;
        }

        /// <summary>The action, with its leading slash.</summary>
        public string Action { get; private set; }

        /// <summary>How it stands.</summary>
        public GoalStatus Status { get; private set; }

        /// <summary>Whether its result has come.</summary>
        public bool IsDone => Status != GoalStatus.Executing && Status != GoalStatus.Canceling;

        internal string Id { get; private set; }

        /// <summary>Whether the application has a handler for what goes wrong.</summary>
        internal abstract bool IsHandled { get; }

        /// <summary>The name of its result, for people.</summary>
        internal string ResultName { get; private set; }

        /// <summary>The name of its feedback, for people.</summary>
        internal string FeedbackName { get; private set; }

        /// <summary>Asks for it to be cancelled. Whether it was, its result tells.</summary>
        public void Cancel()
        {
            lock (_statusGate)
            {
                if (IsDone)
                {
                    return;
                }
                Status = GoalStatus.Canceling;
            }
            _goals.Cancel(this);
        }

        /// <summary>Notes its end, which no request to cancel undoes.</summary>
        protected void Finish(GoalStatus status)
        {
            lock (_statusGate)
            {
                Status = status;
            }
        }

        /// <summary>Reads feedback. Returns how to tell it, or null where that is on its way already.</summary>
        internal abstract Action ReadFeedback(JsonReader reader);

        internal abstract Action ReadResult(GoalStatus status, JsonReader reader);

        internal abstract Action Failed(string errorText);
    }

    /// <summary>The end of a goal: its result, or words that say why it is missing.</summary>
    public struct GoalResult<TResult>
    {
        /// <summary>Succeeded, canceled or aborted. Unknown where there is no result.</summary>
        public readonly GoalStatus Status;

        /// <summary>The result of the server. In all three of these cases there is one.</summary>
        public readonly TResult Value;

        /// <summary>Why there is no result. Null where there is one.</summary>
        public readonly string Error;

        internal GoalResult(GoalStatus status, TResult value, string error) =>
            (Status, Value, Error) = (status, value, error);

        /// <summary>Whether the goal was reached.</summary>
        public bool Succeeded => Status == GoalStatus.Succeeded;
    }

    internal sealed class Goal<TFeedback, TResult> : Goal
        where TFeedback : IMessage, new()
        where TResult : IMessage, new()
    {
        private readonly object _gate = new();
        private readonly Action<TFeedback> _onFeedback;
        private readonly Action<GoalResult<TResult>> _onResult;
        private TFeedback _feedback; // the newest. One that was not looked at makes room for it
        private bool _isFeedbackPosted;

        internal Goal(
            Goals goals, string id, string action, Action<TFeedback> onFeedback, Action<GoalResult<TResult>> onResult)
            : base(goals, id, action) =>
            (_onFeedback, _onResult) = (onFeedback, onResult);

        internal override bool IsHandled => _onResult != null;

        internal override Action ReadFeedback(JsonReader reader)
        {
            TFeedback feedback = new();
            feedback.Read(reader);
            lock (_gate)
            {
                _feedback = feedback;
                if (_isFeedbackPosted)
                {
                    return null;
                }
                _isFeedbackPosted = true;
                return TellFeedback;
            }
        }

        private void TellFeedback()
        {
            TFeedback feedback;
            lock (_gate)
            {
                feedback = _feedback;
                _isFeedbackPosted = false;
            }
            _onFeedback?.Invoke(feedback);
        }

        internal override Action ReadResult(GoalStatus status, JsonReader reader)
        {
            TResult result = new();
            result.Read(reader);
            return () => End(new GoalResult<TResult>(status, result, null));
        }

        internal override Action Failed(string errorText) =>
            () => End(new GoalResult<TResult>(GoalStatus.Unknown, default(TResult), errorText));

        private void End(GoalResult<TResult> result)
        {
            Finish(result.Status);
            _onResult?.Invoke(result);
        }
    }
}
