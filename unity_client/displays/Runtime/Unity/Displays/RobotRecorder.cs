// SPDX-License-Identifier: Apache-2.0
using System;
using System.Globalization;
using System.Linq;
using Ros2Gateway.Json;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>Records the robot to files on the gateway's computer, and knows how the recording stands.</summary>
    /// <remarks>
    /// A recording belongs to no client: another one may stop it, and it goes on when this is disabled. Unity itself
    /// calls any Start, so the methods have longer names.
    /// </remarks>
    [AddComponentMenu("ROS 2 Gateway/Robot Recorder")]
    public sealed class RobotRecorder : ConnectedBehaviour
    {
        private const float AskSeconds = 1; // between two questions for the state

        [SerializeField]
        [Tooltip("Topics to record, such as /camera/**. Empty: all")]
        private string[] _topics = new string[0];

        [SerializeField]
        [Tooltip("The task of the recording, which its files name")]
        private string _task = "";

        [SerializeField]
        [Tooltip("A text for people: the state, or why the gateway refused")]
        private TextEvent _onStatus = new();

        private readonly Listeners<string> _statusChanged;
        private string _told = ""; // of the state: a refusal stays until the state is another
        private float _nextAsk;

        /// <summary>A component of the scene. Made by Unity.</summary>
        public RobotRecorder()
        {
            _statusChanged = new Listeners<string>(ReportFault, "listener of StatusChanged");
            _statusChanged.SetLast("listener of On Status", status => _onStatus.Invoke(status));
        }

        /// <summary>The text for people has changed. Called in Update.</summary>
        public event Action<string> StatusChanged
        {
            add => _statusChanged.Add(value);
            remove => _statusChanged.Remove(value);
        }

        /// <summary>Topics to record, as patterns such as /camera/**. Without any, all topics.</summary>
        public string[] Topics
        {
            get => _topics;
            set => _topics = value;
        }

        /// <summary>The task of the next recording. Empty for none.</summary>
        public string Task
        {
            get => _task;
            set => _task = value;
        }

        /// <summary>The gateway's newest answer, with state, recording, bytes, and episode. Null while it is unknown.</summary>
        public JsonValue State { get; private set; }

        /// <summary>Whether the gateway records.</summary>
        public bool IsRecording => State != null && State["state"].AsString() == "recording";

        /// <summary>A text for people: the state, or why the gateway refused. Null before the first.</summary>
        public string Status { get; private set; }

        /// <summary>Starts a recording. One is possible at a time. For a button.</summary>
        public void StartRecording()
        {
            JsonValue members = JsonValue.Object().With("task", _task);
            Ask("start", _topics.Length == 0 ? members : members.With(
                "topics", JsonValue.Array(_topics.Select(topic => (JsonValue)topic).ToArray())));
        }

        /// <summary>Stops the recording, also that of another client, and completes its files. For a button.</summary>
        public void StopRecording() => Ask("stop", JsonValue.Object());

        /// <summary>Writes a note with its time into the recording.</summary>
        public void Mark(string text) => Ask("mark", JsonValue.Object().With("text", text ?? ""));

        /// <inheritdoc/>
        protected override void Bind(GatewayConnection connection) => _nextAsk = 0;

        /// <inheritdoc/>
        protected override void Unbind(GatewayConnection connection) => State = null;

        private void Update()
        {
            if (IsBound && Connection.Client.IsConnected && Time.unscaledTime >= _nextAsk)
            {
                Ask("status", JsonValue.Object());
            }
        }

        private void Ask(string action, JsonValue members)
        {
            _nextAsk = Time.unscaledTime + AskSeconds;
            if (IsBound)
            {
                Connection.Client.Request("record", members.With("action", action), Take);
            }
        }

        private void Take(Reply<JsonValue> reply)
        {
            if (!IsBound)
            {
                return;
            }
            State = reply.Ok ? reply.Value : State;
            string status = reply.Ok ? InWords(reply.Value) : reply.Error;
            if (status != (reply.Ok ? _told : Status))
            {
                _told = reply.Ok ? status : _told;
                Status = status;
                _statusChanged.Call(status);
            }
        }

        private static string InWords(JsonValue state)
        {
            string why = state["why"].AsString();
            return state["state"].AsString() + (why.Length > 0 ? ": " + why
                : state["recording"].Exists ? string.Format(
                    CultureInfo.InvariantCulture, " {0}, {1:0} s, {2:0.0} MB", state["recording"].AsString(),
                    state["duration_s"].AsDouble(0), state["bytes"].AsDouble(0) / 1e6)
                : "");
        }
    }
}
