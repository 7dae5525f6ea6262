// SPDX-License-Identifier: Apache-2.0
using System;
using System.Diagnostics;
using System.Globalization;
using Ros2Gateway.Json;

namespace Ros2Gateway.Editor
{
    /// <summary>
    /// Tries a connection once: who answers, and how fast. Or why nobody does. It lets go of the connection
    /// as soon as it knows. Pump it from the editor's update until <see cref="IsDone"/>.
    /// </summary>
    public sealed class ConnectionProbe : IDisposable
    {
        private readonly EditorClient _client;
        private readonly Stopwatch _watch = Stopwatch.StartNew();
        private readonly int _timeoutMilliseconds;
        private string _server;
        private bool _isAsked;

        /// <summary>Begins to connect, to where these options say.</summary>
        public ConnectionProbe(GatewayOptions options)
        {
            // one attempt, and as long again for its answers
            _timeoutMilliseconds = 2 * options.ConnectMilliseconds;
            _client = new EditorClient(options);
            Text = _client.Problem;
        }

        /// <summary>Whether <see cref="Text"/> is the result.</summary>
        public bool IsDone { get; private set; }

        /// <summary>Whether a gateway has answered.</summary>
        public bool IsGood { get; private set; }

        /// <summary>
        /// The server, its version and the round trip, or the error. Before, what is being done.
        /// </summary>
        public string Text { get; private set; }

        /// <summary>Goes on with it.</summary>
        public void Pump()
        {
            if (IsDone)
            {
                return;
            }
            _client.Pump();
            if (_client.Client.IsConnected && !_isAsked)
            {
                _isAsked = true;
                Text = "connected, waiting for an answer";
                _client.Client.Request("hello", null, Hear);
            }
            ClockOffset clock = _client.Client.RosClock;
            if (_server != null && clock.IsKnown)
            {
                string trip = clock.RoundTripMilliseconds.ToString("0.0", CultureInfo.InvariantCulture);
                End(true, _server + "; round trip " + trip + " ms");
            }
            else if (_client.Client.State == ConnectionState.Waiting
                || _client.Client.State == ConnectionState.Refused)
            {
                End(false, _client.Problem);
            }
            else if (_watch.ElapsedMilliseconds > _timeoutMilliseconds)
            {
                End(false, "no answer from " + _client.Address + " in " + _timeoutMilliseconds + " ms");
            }
        }

        /// <summary>Gives up, unless it is done.</summary>
        public void Dispose()
        {
            IsDone = true;
            _client.Dispose();
        }

        private void Hear(Reply<JsonValue> hello)
        {
            if (hello.Ok)
            {
                _server = hello.Value["server"].AsString("a rosbridge server") + " "
                    + hello.Value["version"].AsString("of unknown version") + ", ROS 2 "
                    + hello.Value["ros_distro"].AsString("unknown") + ", role "
                    + hello.Value["role"].AsString("unknown");
            }
            else if (!IsDone)
            {
                End(false, hello.Error);
            }
        }

        private void End(bool isGood, string text)
        {
            IsGood = isGood;
            Text = text;
            Dispose();
        }
    }
}
