// SPDX-License-Identifier: Apache-2.0
using System;
using System.Diagnostics;
using System.Threading;
using Ros2Gateway.Drive;
using Ros2Gateway.Messages.GeometryMsgs;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// Publishes commands as the topic takes them, Twist or TwistStamped, and nothing before it is known which.
    /// It knows whether the robot may still be moving by them: after a connection was lost in the middle of driving,
    /// the first thing that the robot hears is zero. And when the application freezes in the middle of driving, a
    /// separate timer sends zero. If the gateway has stopped the robot, zeros that are sent once nobody pushes
    /// any more allow to drive on.
    /// </summary>
    internal sealed class DriveOutput : IDisposable
    {
        // Both drivers send ten times a second or more. Unity's Pause button, a breakpoint or a scene that
        // loads stop Update, and nothing else: the connection stays, and looks well.
        private const int FrozenMilliseconds = 300;
        private const int CheckMilliseconds = 50;

        // Between two zeros for a robot that was stopped: one is enough, unless it was late or refused.
        private const int ZeroMilliseconds = 100;

        private readonly object _gate = new(); // the timer has its own thread
        private readonly GatewayConnection _connection;
        private readonly GatewayClient _client;
        private readonly string _topic;
        private readonly CommandType _type;
        private readonly RobotControl _control;
        private readonly TwistMsg _twist = new();
        private readonly TwistStampedMsg _stamped = new(); // with a stamp of 0: the gateway's time
        private readonly Stopwatch _clock = Stopwatch.StartNew();
        private readonly Stopwatch _sinceSent = new();
        private readonly Stopwatch _sinceZero = Stopwatch.StartNew();
        private readonly Timer _deadMan; // null where there are no threads: there the page is what freezes
        private Publisher _publisher; // null while no type is known
        private bool _isMoving;
        private bool _hasPushed; // so it may be this driver whom the gateway waits for to let go
        private bool _isUp;

        internal DriveOutput(GatewayConnection connection, string topic)
        {
            _connection = connection;
            _client = connection.Client;
            _topic = topic;
            _type = new CommandType(topic);
            _stamped.twist = _twist;
            _control = _client.Control(topic);
            _isUp = _client.IsConnected;
            _client.WatchGraph(See);
            connection.StateChanged += Changed;
            connection.Leaving += Leave; // a scene may disable the connection first
#if !UNITY_WEBGL || UNITY_EDITOR
            _deadMan = new Timer(state => StandIfFrozen(), null, CheckMilliseconds, CheckMilliseconds);
#endif
        }

        /// <summary>Whether a command would go now.</summary>
        internal bool IsConnected => Missing == null;

        /// <summary>The reason why no command can go, in words, or null.</summary>
        internal string Missing => _isUp && _client.IsConnected ? _type.Reason : "connection lost";

        /// <summary>The type that is published, pkg/msg/Name. Null while it is not known.</summary>
        internal string Type => _type.Name;

        /// <summary>The driver, and whether the robot may be driven.</summary>
        internal ControlState Control => _control.State;

        /// <summary>Why no command to move goes, or null.</summary>
        internal string Refusal => _publisher == null ? _type.Reason : _publisher.Refusal;

        /// <summary>How things stand, in words for people.</summary>
        internal string Status => !_isUp || !_client.IsConnected ? "not connected" : Refusal ?? _control.State.ToString();

        /// <summary>
        /// Another number than before means that the connection is another, or the type. A connection that was lost
        /// and made again between two frames is never seen as lost. A key that is held when a robot comes up must
        /// not move it.
        /// </summary>
        internal int Changes { get; private set; }

        /// <summary>Does what is due. In every frame.</summary>
        internal void Tick()
        {
            _type.Tick(_clock.ElapsedMilliseconds);
            Advertise();
        }

        /// <summary>Sends a command. False if it does not go. Zero goes even late, when a network is back.</summary>
        internal bool Send(DriveCommand command)
        {
            lock (_gate)
            {
                return _isUp && Publish(command);
            }
        }

        /// <summary>
        /// Stops the robot, even if another client drives. If the gateway knows no robot behind the topic, it sends a zero.
        /// </summary>
        internal void Stop()
        {
            if (_control.State.IsKnown)
            {
                _control.Stop();
            }
            if (_control.State.Holder != ControlHolder.Other)
            {
                Send(DriveCommand.Zero);
            }
        }

        /// <summary>
        /// Whether a robot that was stopped may be driven again: sends zeros until it may.
        /// </summary>
        internal bool LetGo()
        {
            lock (_gate)
            {
                ControlState state = _control.State;
                if (_isUp && state.IsTripped && state.Holder != ControlHolder.Other
                    && _sinceZero.ElapsedMilliseconds >= ZeroMilliseconds)
                {
                    Publish(DriveCommand.Zero);
                }
                return !state.IsTripped;
            }
        }

        /// <summary>
        /// Nobody pushes, call it in every frame of that: where this driver was stopped by the gateway, zeros go
        /// until it may drive again. A driver that has not driven leaves the latch to those who have.
        /// </summary>
        internal void Rest()
        {
            ControlState state = _control.State;
            bool isOver = state.Holder == ControlHolder.Other
                || (!state.IsTripped && state.Holder == ControlHolder.None && !_isMoving);
            if (state.IsKnown && isOver)
            {
                _hasPushed = false;
            }
            else if (_hasPushed)
            {
                LetGo();
            }
        }

        /// <summary>
        /// Sends zero, unless that was the last command that went. Without a connection later.
        /// </summary>
        internal void Stand()
        {
            lock (_gate)
            {
                if (_isMoving && _isUp)
                {
                    Publish(DriveCommand.Zero);
                }
            }
        }

        public void Dispose()
        {
            if (_deadMan != null)
            {
                _deadMan.Dispose();
            }
            Stand();
            _control.Dispose();
            _client.UnwatchGraph(See);
            if (_publisher != null)
            {
                _publisher.Dispose();
            }
            _connection.StateChanged -= Changed;
            _connection.Leaving -= Leave;
        }

        private void See(RosGraph graph)
        {
            _type.See(graph, _clock.ElapsedMilliseconds);
            Advertise();
        }

        /// <summary>Advertises the type that is known now, and no other.</summary>
        private void Advertise()
        {
            lock (_gate)
            {
                if (_type.Name == (_publisher == null ? null : _publisher.Type))
                {
                    return;
                }
                if (_publisher != null)
                {
                    Stand();
                    _publisher.Dispose();
                    _publisher = null;
                    _isMoving = false;
                }
                if (_type.Name != null)
                {
                    _publisher = _client.Advertise(_topic, _type.Name, new AdvertiseOptions { Queue = 1 });
                }
                Changes++;
            }
        }

        private void StandIfFrozen()
        {
            lock (_gate)
            {
                // While commands are refused it is the gateway that has stopped the robot, and a zero of ours would
                // say that a stick was let go of.
                bool isSilent = _sinceSent.ElapsedMilliseconds > FrozenMilliseconds;
                if (_isMoving && isSilent && Refusal == null)
                {
                    Publish(DriveCommand.Zero);
                }
            }
        }

        private bool Publish(DriveCommand command)
        {
            bool isZero = command.Equals(DriveCommand.Zero);
            _twist.linear.x = command.linear;
            _twist.angular.z = command.angular;
            _hasPushed |= !isZero;
            bool isStamped = _publisher != null && _publisher.Type == TwistStampedMsg.Type;
            bool isSent = _publisher != null && _client.IsConnected
                && _publisher.Publish(isStamped ? (IMessage)_stamped : _twist, isZero);
            if (isSent)
            {
                _isMoving = !isZero;
                _sinceSent.Restart();
                if (isZero)
                {
                    _sinceZero.Restart();
                }
            }
            return isSent;
        }

        private void Leave(GatewayConnection connection) => Stand();

        private void Changed(ConnectionState state)
        {
            _isUp = state == ConnectionState.Connected;
            Changes++;
        }
    }
}
