// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>
    /// The driver of the robot behind a command topic, whether it may be driven, and the means to stop it and to
    /// take or release control. It survives reconnections and ends with <see cref="Dispose"/>.
    /// </summary>
    /// <remarks>
    /// You do not need this to drive: the first client to send a command has control, and loses it two seconds after the last
    /// command. Control that was taken by <see cref="Acquire"/> is taken back after a reconnection if nobody
    /// else has it then. Methods may be called from any thread.
    /// </remarks>
    public sealed class RobotControl : IDisposable
    {
        private readonly Controls _controls;
        private readonly Requests _requests;
        private readonly ControlTopic _topic;
        private readonly int _timeoutMilliseconds;
        private readonly Listeners<ControlState> _changed;
        private bool _isDisposed;

        internal RobotControl(Controls controls, Requests requests, string topic, int timeoutMilliseconds)
        {
            _controls = controls;
            _requests = requests;
            _timeoutMilliseconds = timeoutMilliseconds;
            _topic = controls.Open(topic);
            _changed = new Listeners<ControlState>(_topic.ReportFault, "listener of who drives " + topic);
            _topic.Add(Tell);
        }

        /// <summary>
        /// The state has changed, or is known for the first time. Called by <see cref="GatewayClient.Pump"/>, with
        /// the newest.
        /// </summary>
        public event Action<ControlState> Changed
        {
            add { _changed.Add(value); }
            remove { _changed.Remove(value); }
        }

        /// <summary>The command topic, with its leading slash.</summary>
        public string Topic
        {
            get { return _topic.Name; }
        }

        /// <summary>The newest state. Never null, but <see cref="ControlState.IsKnown"/> may be false.</summary>
        public ControlState State
        {
            get { return _topic.State; }
        }

        /// <summary>
        /// Stops the robot, even if another client drives. If that is another client, it has to let go before it can drive on.
        /// </summary>
        /// <param name="done">Gets the topics that are stopped: none if no type of the topic is known yet.</param>
        public void Stop(Action<Reply<string[]>> done = null)
        {
            Stop(_controls, _requests, Topic, done, _timeoutMilliseconds);
        }

        /// <summary>
        /// Takes control, also from another client: first the gateway stops its robot. Commands keep it, also
        /// zeros. After two seconds without any it is free.
        /// </summary>
        public void Acquire(Action<Reply<ControlState>> done = null)
        {
            Send("acquire_control", done);
        }

        /// <summary>Gives control back. A moving robot stops.</summary>
        public void Release(Action<Reply<ControlState>> done = null)
        {
            _controls.GiveBack(_topic);
            Send("release_control", done);
        }

        /// <summary>Calls no handler any more. This does not change who has control.</summary>
        public void Dispose()
        {
            if (!_isDisposed)
            {
                _isDisposed = true;
                _topic.Remove(Tell);
                _controls.Close(_topic);
            }
        }

        /// <summary>Stops one robot, or all without a topic.</summary>
        internal static void Stop(
            Controls controls, Requests requests, string topic, Action<Reply<string[]>> done, int timeoutMilliseconds)
        {
            if (done == null)
            {
                controls.Stop(topic); // so that a scene that ends now has no open question
                return;
            }
            requests.Send(
                "stop",
                topic == null ? "stop" : "stop " + topic,
                frame =>
                {
                    if (topic != null)
                    {
                        frame.Member("topic", topic);
                    }
                },
                ReadTopics,
                done,
                timeoutMilliseconds);
        }

        private void Send(string op, Action<Reply<ControlState>> done)
        {
            _requests.Send(
                op,
                op + " " + Topic,
                frame => frame.Member("topic", Topic),
                reader => ControlState.Read(JsonValue.Read(reader)),
                done,
                _timeoutMilliseconds);
        }

        private void Tell(ControlState state)
        {
            _changed.Call(state);
        }

        private static string[] ReadTopics(JsonReader reader)
        {
            JsonValue topics = JsonValue.Read(reader)["topics"];
            string[] names = new string[topics.Count];
            for (int i = 0; i < names.Length; i++)
            {
                names[i] = topics[i].AsString();
            }
            return names;
        }
    }
}
