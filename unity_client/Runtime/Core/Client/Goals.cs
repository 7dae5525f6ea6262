// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>The goals of a client that are under way. Each gets its result, once.</summary>
    internal sealed class Goals
    {
        // Four times what a gateway pursues for a client by default. It refuses what is beyond its own limit.
        private const int MaxGoals = 64;

        private readonly object _gate = new object();
        private readonly Outbox _outbox;
        private readonly Mailbox _mailbox;
        private readonly Reports _reports;
        private readonly Dictionary<string, Goal> _goals = new Dictionary<string, Goal>();
        private long _count;

        internal Goals(Outbox outbox, Mailbox mailbox, Reports reports)
        {
            _outbox = outbox;
            _mailbox = mailbox;
            _reports = reports;
        }

        internal int Count
        {
            get
            {
                lock (_gate)
                {
                    return _goals.Count;
                }
            }
        }

        internal Goal Send<TFeedback, TResult>(
            string action, IMessage goal, Action<TFeedback> onFeedback, Action<GoalResult<TResult>> onResult, bool keep,
            bool isAwaited = false)
            where TFeedback : IMessage, new()
            where TResult : IMessage, new()
        {
            Goal sent;
            lock (_gate)
            {
                _count++;
                sent = new Goal<TFeedback, TResult>(this, "g" + _count, action, onFeedback, onResult)
                {
                    IsAwaited = isAwaited,
                };
                if (_goals.Count >= MaxGoals)
                {
                    Fail(sent, "at most " + MaxGoals + " goals at once");
                    return sent;
                }
                _goals[sent.Id] = sent;
            }
            JsonWriter frame = Begin("send_action_goal", sent);
            try
            {
                Names.WriteArguments(frame, goal, "goal", "action_type", "_Goal");
                frame.Member("feedback", onFeedback != null);
                frame.Member("nonfinite", "string");
                if (keep)
                {
                    frame.Member("keep", true);
                }
                frame.EndObject();
            }
            catch (Exception error)
            {
                // A message may be a class of the application's, which may throw anything.
                Fail(sent.Id, error.Message);
                return sent;
            }
            string refusal = _outbox.Post(frame);
            if (refusal != null)
            {
                Fail(sent.Id, refusal);
            }
            return sent;
        }

        internal void Cancel(Goal goal)
        {
            JsonWriter frame = Begin("cancel_action_goal", goal);
            frame.EndObject();
            _outbox.Post(frame);
        }

        internal void OnFeedback(string id, JsonReader reader)
        {
            Goal goal = Find(id, false);
            Action tell = goal == null ? null : goal.ReadFeedback(reader);
            if (tell != null)
            {
                _mailbox.Post(goal.FeedbackName, tell);
            }
        }

        internal void OnResult(string id, GoalStatus status, JsonReader reader)
        {
            Goal goal = Find(id, true);
            if (goal == null)
            {
                return;
            }
            try
            {
                _mailbox.Post(goal.ResultName, goal.ReadResult(status, reader));
            }
            catch (Exception error)
            {
                // Not only a JsonFormatException: the message may be a class of the application's.
                Fail(goal, "result cannot be read: " + error.Message);
            }
        }

        internal void Fail(string id, string errorText)
        {
            Goal goal = Find(id, true);
            if (goal != null)
            {
                Fail(goal, errorText);
            }
        }

        internal void FailAll(string errorText)
        {
            List<Goal> all;
            lock (_gate)
            {
                all = new List<Goal>(_goals.Values);
                _goals.Clear();
            }
            foreach (Goal goal in all)
            {
                Fail(goal, errorText);
            }
        }

        private void Fail(Goal goal, string errorText)
        {
            _reports.Failure("send_action_goal " + goal.Action, errorText, goal.IsAwaited);
            _mailbox.Post(goal.ResultName, goal.Failed(errorText));
        }

        private Goal Find(string id, bool isLast)
        {
            lock (_gate)
            {
                Goal goal;
                if (id == null || !_goals.TryGetValue(id, out goal))
                {
                    return null;
                }
                if (isLast)
                {
                    _goals.Remove(id);
                }
                return goal;
            }
        }

        private JsonWriter Begin(string op, Goal goal)
        {
            JsonWriter frame = _outbox.Rent();
            frame.Begin(op, goal.Id);
            frame.Member("action", goal.Action);
            return frame;
        }
    }
}
