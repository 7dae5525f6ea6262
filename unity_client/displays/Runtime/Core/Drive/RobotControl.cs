// SPDX-License-Identifier: Apache-2.0
using System;
using System.Linq;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>Calls of a client about the drivers of robots.</summary>
    public static class RobotControls
    {
        /// <summary>
        /// Watches who drives the robot behind a command topic and whether it may be driven. By what this returns
        /// it is stopped, and control taken.
        /// </summary>
        /// <param name="changed">Called by <see cref="GatewayClient.Pump"/> with each change. Null for none.</param>
        public static RobotControl Control(
            this GatewayClient client, string topic = "/cmd_vel", Action<ControlState> changed = null)
        {
            RobotControl control = new(client, Names.Absolute(topic));
            if (changed != null)
            {
                control.Changed += changed;
            }
            return control;
        }

        /// <summary>Stops every robot of the gateway, even if another client drives. Any client may.</summary>
        /// <param name="done">Gets the command topics that are stopped.</param>
        public static void StopRobots(this GatewayClient client, Action<Reply<string[]>> done = null) =>
            RobotControl.Stop(client, null, done);
    }

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
        private readonly GatewayClient _client;
        private readonly ControlTopic _topic;
        private readonly Listeners<ControlState> _changed;
        private bool _isDisposed;

        internal RobotControl(GatewayClient client, string topic)
        {
            _client = client;
            _controls = Controls.Of(client);
            _topic = _controls.Open(topic);
            _changed = new Listeners<ControlState>(_topic.ReportFault, "listener of who drives " + topic);
            _topic.Add(Tell);
        }

        /// <summary>
        /// The state has changed, or is known for the first time. Called by <see cref="GatewayClient.Pump"/>, with
        /// the newest.
        /// </summary>
        public event Action<ControlState> Changed
        {
            add => _changed.Add(value);
            remove => _changed.Remove(value);
        }

        /// <summary>The command topic, with its leading slash.</summary>
        public string Topic => _topic.Name;

        /// <summary>The newest state. Never null, but <see cref="ControlState.IsKnown"/> may be false.</summary>
        public ControlState State => _topic.State;

        /// <summary>
        /// Stops the robot, even if another client drives. If that is another client, it has to let go before it can drive on.
        /// </summary>
        /// <param name="done">Gets the topics that are stopped: none if no type of the topic is known yet.</param>
        public void Stop(Action<Reply<string[]>> done = null) => Stop(_client, Topic, done);

        /// <summary>
        /// Takes control, also from another client: first the gateway stops its robot. Commands keep it, also
        /// zeros. After two seconds without any it is free.
        /// </summary>
        public void Acquire(Action<Reply<ControlState>> done = null) => Send("acquire_control", done);

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
        internal static void Stop(GatewayClient client, string topic, Action<Reply<string[]>> done)
        {
            if (done == null)
            {
                Controls.Of(client).Stop(topic); // so that a scene that ends now has no open question
                return;
            }
            JsonValue members = topic == null ? null : JsonValue.Object().With("topic", topic);
            client.Request("stop", members, reply => done(reply.Ok
                ? Reply<string[]>.Of(reply.Value["topics"].Items.Select(one => one.AsString("")).ToArray())
                : Reply<string[]>.Failed(reply.Error)));
        }

        private void Send(string op, Action<Reply<ControlState>> done) => _client.Request(
            op,
            JsonValue.Object().With("topic", Topic),
            done == null ? null : reply => done(reply.Ok
                ? Reply<ControlState>.Of(ControlState.Read(reply.Value)) : Reply<ControlState>.Failed(reply.Error)));

        private void Tell(ControlState state) => _changed.Call(state);
    }
}
