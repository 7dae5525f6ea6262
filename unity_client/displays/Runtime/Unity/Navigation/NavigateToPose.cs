// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Globalization;
using Ros2Gateway.Navigation;
using UnityEngine;
using UnityEngine.Events;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// Sends the robot to places by Nav2's action, says how far it is and how it ended, and calls it off. A newer goal
    /// replaces the one that is pursued.
    /// </summary>
    /// <remarks>Disabling it cancels the goal: a robot must not drive on for a scene that is gone.</remarks>
    [AddComponentMenu("ROS 2 Gateway/Navigate To Pose")]
    public sealed class NavigateToPose : ConnectedBehaviour
    {
        [SerializeField]
        private string _action = "/navigate_to_pose";

        [SerializeField]
        [Tooltip("Empty: the one above in the hierarchy")]
        private FixedFrame _fixedFrame;

        [SerializeField]
        [Tooltip("Without a Fixed Frame: the frame whose origin is that of the scene")]
        private string _frame = "map";

        [SerializeField]
        [Tooltip("The behavior tree to use, as a path on the robot. Empty for the usual one")]
        private string _behaviorTree = "";

        [SerializeField]
        [Tooltip("A text for people: the distance to go, or how it ended")]
        private TextEvent _onStatus = new();

        [SerializeField]
        private UnityEvent _onReached = new();

        [SerializeField]
        [Tooltip("It was rejected, aborted or canceled, or the connection is lost")]
        private UnityEvent _onEnded = new();

        // Until its result has come a goal may be pursued: one that was sent later may be refused. The client knows
        // of each of them as long.
        private readonly List<Goal> _open = new();
        private readonly Listeners<string> _statusChanged;
        private readonly Listeners<bool> _ended; // whether it was reached. The lists of the Inspector
        private Goal _goal; // whose news is told

        /// <summary>A component of the scene. Made by Unity.</summary>
        public NavigateToPose()
        {
            _statusChanged = new Listeners<string>(ReportFault, "listener of StatusChanged");
            _statusChanged.SetLast("listener of On Status", status => _onStatus.Invoke(status));
            _ended = new Listeners<bool>(ReportFault, "listener of On Reached or On Ended");
            _ended.Add(isReached => (isReached ? _onReached : _onEnded).Invoke());
        }

        /// <summary>The text for people has changed.</summary>
        public event Action<string> StatusChanged
        {
            add => _statusChanged.Add(value);
            remove => _statusChanged.Remove(value);
        }

        /// <summary>The action. A change counts for the next goal.</summary>
        public string Action
        {
            get => _action;
            set => _action = value;
        }

        /// <summary>In what goals are given. Null for the one above.</summary>
        public FixedFrame FixedFrame
        {
            get => _fixedFrame;
            set => _fixedFrame = value;
        }

        /// <summary>Without a Fixed Frame: the frame whose origin is that of the scene.</summary>
        public string Frame
        {
            get => _frame;
            set => _frame = value;
        }

        /// <summary>How it stands, in words. Empty before the first goal.</summary>
        public string Status { get; private set; }

        /// <summary>
        /// How the newest goal stands, or the one before if that is pursued as the newest was refused. Unknown before
        /// the first.
        /// </summary>
        public GoalStatus GoalStatus => _goal == null ? GoalStatus.Unknown : _goal.Status;

        /// <summary>Whether a goal is pursued, be it an older one, or may be: its result has not come.</summary>
        public bool IsActive => _open.Exists(goal => !goal.IsDone);

        /// <summary>The last feedback of the action server on the goal of <see cref="GoalStatus"/>. Null before that.</summary>
        public NavigateToPoseFeedback Feedback { get; private set; }

        /// <summary>Called when a goal was reached, from the Inspector's list.</summary>
        public UnityEvent OnReached => _onReached;

        /// <summary>Called when a goal ended otherwise, from the Inspector's list.</summary>
        public UnityEvent OnEnded => _onEnded;

        /// <summary>Sends the robot to this object. For a button.</summary>
        public void Send() => Send(transform);

        /// <summary>Sends the robot to a place. Its forward is the heading, height and tilt do not count.</summary>
        public void Send(Transform place)
        {
            if (!IsBound)
            {
                Tell("not sent: " + (isActiveAndEnabled ? "no Gateway Connection" : "this component is disabled"));
                return;
            }
            NavigateToPoseGoal goal = new()
            {
                pose = GoalPoses.Of(place, FixedFrame.For(this, _fixedFrame), _frame),
                behavior_tree = _behaviorTree,
            };
            Feedback = null;
            Goal sent = null; // the result of an older goal is not news
            sent = Connection.Client.SendGoal<NavigateToPoseFeedback, NavigateToPoseResult>(
                _action, goal, feedback => Hear(sent, feedback), result => End(sent, result));
            _goal = sent;
            _open.Add(sent);
            Tell("in progress");
        }

        /// <summary>Calls off whatever is pursued.</summary>
        public void Cancel()
        {
            if (IsActive)
            {
                foreach (Goal goal in _open)
                {
                    goal.Cancel(); // its result comes later, by the pump
                }
                Tell("cancelling");
            }
        }

        private void Awake() => Status = "";

        /// <inheritdoc/>
        protected internal override bool MovesRobots => true;

        /// <inheritdoc/>
        protected override void Bind(GatewayConnection connection)
        {
        }

        /// <inheritdoc/>
        protected override void Unbind(GatewayConnection connection)
        {
            Cancel();
            if (connection.IsOver)
            {
                _open.Clear(); // no result will come
            }
        }

        private void Hear(Goal goal, NavigateToPoseFeedback feedback)
        {
            if (goal == _goal && GoalStatus == GoalStatus.Executing)
            {
                Feedback = feedback;
                string text = feedback.distance_remaining.ToString("0.0", CultureInfo.InvariantCulture) + " m to go";
                Tell(feedback.number_of_recoveries > 0
                    ? text + ", stuck " + feedback.number_of_recoveries + " times" : text);
            }
        }

        private void End(Goal goal, GoalResult<NavigateToPoseResult> result)
        {
            _open.Remove(goal);
            if (goal != _goal)
            {
                return;
            }
            if (result.Value == null && _open.Count > 0)
            {
                _goal = _open[_open.Count - 1]; // refused, so it has replaced nothing
            }
            Tell(result.Succeeded ? "reached" : Reason(result));
            _ended.Call(result.Succeeded);
        }

        private static string Reason(GoalResult<NavigateToPoseResult> result)
        {
            if (result.Status == GoalStatus.Canceled)
            {
                return "cancelled";
            }
            if (result.Value == null)
            {
                return result.Error;
            }
            string text = result.Value.error_msg;
            return "given up" + (string.IsNullOrEmpty(text) ? "" : ": " + text)
                + (result.Value.error_code == 0 ? "" : " (" + result.Value.error_code + ")");
        }

        private void Tell(string status)
        {
            if (status == Status)
            {
                return;
            }
            Status = status;
            _statusChanged.Call(status);
        }
    }
}
