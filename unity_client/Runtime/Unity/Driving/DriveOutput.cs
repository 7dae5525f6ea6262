// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Drive;
using Ros2Gateway.Messages.GeometryMsgs;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// Publishes commands as Twist, and knows whether the robot may still be moving by them: after a
    /// connection was lost in the middle of driving, the first thing that the robot hears is zero.
    /// </summary>
    internal sealed class DriveOutput : IDisposable
    {
        private readonly GatewayConnection _connection;
        private readonly Publisher<TwistMsg> _publisher;
        private readonly TwistMsg _twist = new TwistMsg();
        private bool _isMoving;
        private bool _isUp;

        internal DriveOutput(GatewayConnection connection, string topic)
        {
            _connection = connection;
            // A command that waited is one for a robot that is elsewhere by now.
            _publisher = connection.Client.Advertise<TwistMsg>(topic, new AdvertiseOptions { Queue = 1 });
            _isUp = connection.Client.IsConnected;
            connection.StateChanged += Changed;
            connection.Leaving += Stand; // a scene may disable the connection first
        }

        /// <summary>Whether a command would go now.</summary>
        internal bool IsConnected
        {
            get { return _connection != null && _isUp && _connection.Client.IsConnected; }
        }

        /// <summary>
        /// Another number than before means that the connection is another, too: one that was lost and made
        /// again between two frames is never seen as lost.
        /// </summary>
        internal int Changes { get; private set; }

        /// <summary>Sends a command; false if it does not go.</summary>
        internal bool Send(DriveCommand command)
        {
            _twist.linear.x = command.linear;
            _twist.angular.z = command.angular;
            bool isSent = IsConnected && _publisher.Publish(_twist);
            if (isSent)
            {
                _isMoving = !command.Equals(DriveCommand.Zero);
            }
            return isSent;
        }

        /// <summary>
        /// Sends zero, unless that was the last command that went; without a connection later.
        /// </summary>
        internal void Stand()
        {
            if (_isMoving)
            {
                Send(DriveCommand.Zero);
            }
        }

        public void Dispose()
        {
            Stand();
            _publisher.Dispose();
            _connection.StateChanged -= Changed;
            _connection.Leaving -= Stand;
        }

        private void Changed(ConnectionState state)
        {
            _isUp = state == ConnectionState.Connected;
            Changes++;
        }
    }
}
