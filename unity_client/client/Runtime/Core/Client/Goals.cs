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

        private readonly object _gate = new();
        private readonly GatewayClient _client;
        private readonly Dictionary<string, Goal> _goals = new();
        private long _count;

        internal Goals(GatewayClient client) => _client = client;

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
            string action, IMessage goal, Action<TFeedback> onFeedback, Action<GoalResult<TResult>> onResult, bool keep)
            where TFeedback : IMessage, new()
            where TResult : IMessage, new()
        {
            Goal sent;
            lock (_gate)
            {
                sent = new Goal<TFeedback, TResult>(this, "g" + ++_count, action, onFeedback, onResult);
                if (_goals.Count >= MaxGoals)
                {
                    Fail(sent, "at most " + MaxGoals + " goals at once");
                    return sent;
                }
                _goals[sent.Id] = sent;
            }
            string refusal;
            try
            {
                refusal = _client.Outbox.Send("send_action_goal", sent.Id, frame =>
                {
                    frame.Name("action").Value(action);
                    Names.WriteArguments(frame, goal, "goal", "action_type", "_Goal");
                    frame.Name("feedback").Value(onFeedback != null);
                    frame.Name("nonfinite").Value("string");
                    frame.Name("keep").Value(keep);
                });
            }
            catch (Exception error)
            {
                refusal = error.Message; // a message may be a class of the application's, which may throw anything
            }
            if (refusal != null)
            {
                Fail(sent.Id, refusal);
            }
            return sent;
        }

        internal void Cancel(Goal goal) =>
            _client.Outbox.Send("cancel_action_goal", goal.Id, frame => frame.Name("action").Value(goal.Action));

        internal void OnFeedback(string id, JsonReader reader)
        {
            Goal goal = Find(id, false);
            Action tell = goal?.ReadFeedback(reader);
            if (tell != null)
            {
                _client.Mailbox.Post(goal.FeedbackName, tell);
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
                _client.Mailbox.Post(goal.ResultName, goal.ReadResult(status, reader));
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
            _client.Reports.Failure("send_action_goal " + goal.Action, errorText, goal.IsHandled);
            _client.Mailbox.Post(goal.ResultName, goal.Failed(errorText));
        }

        private Goal Find(string id, bool isLast)
        {
            lock (_gate)
            {
                if (id == null || !_goals.TryGetValue(id, out Goal goal))
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
    }
}
