// SPDX-License-Identifier: Apache-2.0
using System.Globalization;
using System.Text;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>Shows how the connection is: state, address, round trip, rates, losses.</summary>
    [AddComponentMenu("ROS 2 Gateway/Connection HUD")]
    public sealed class ConnectionHud : MonoBehaviour
    {
        private const float Interval = 0.5f; // seconds: figures that change more often cannot be read

        [SerializeField]
        [Tooltip("Empty: the connection of the scene")]
        private GatewayConnection _connection;

        [SerializeField]
        private Color _connectedColor = Color.green;

        [SerializeField]
        private Color _waitingColor = Color.yellow;

        [SerializeField]
        private Color _refusedColor = Color.red;

        [SerializeField]
        private Color _disconnectedColor = Color.gray;

        [SerializeField]
        private TextOutput _text = new();

        private readonly StringBuilder _builder = new();
        private float _next;
        private float _last;
        private long _lastFrames;
        private long _lastBytes;
        private GatewayConnection _counted;

        /// <summary>Whose connection is shown. Null for the scene's.</summary>
        public GatewayConnection Connection
        {
            get => _connection;
            set => _connection = value;
        }

        /// <summary>How many messages came each second, lately.</summary>
        public float MessagesPerSecond { get; private set; }

        /// <summary>How many kilobytes (1000 bytes) came each second, lately.</summary>
        public float KilobytesPerSecond { get; private set; }

        /// <summary>The text, and its places.</summary>
        public TextOutput Output => _text;

        private void OnEnable()
        {
            _text.Demand(this, false);
            _next = 0;
            _counted = null;
        }

        private void Update()
        {
            float now = Time.unscaledTime;
            if (now < _next)
            {
                return;
            }
            _next = now + Interval;
            GatewayConnection connection = LiveConnections.Best(this, _connection, _counted);
            if (connection == null)
            {
                _text.Show("no Gateway Connection in the scene");
                _text.Paint(_disconnectedColor);
                return;
            }
            Count(connection, now);
            _text.Show(Words(connection));
            _text.Paint(ColorOf(connection.Client.State));
        }

        private void Count(GatewayConnection connection, float now)
        {
            long frames = connection.Client.FramesReceived;
            long bytes = connection.Client.BytesReceived;
            bool isFirst = connection != _counted || now <= _last;
            MessagesPerSecond = isFirst ? 0 : (frames - _lastFrames) / (now - _last);
            KilobytesPerSecond = isFirst ? 0 : (bytes - _lastBytes) / (now - _last) / 1000;
            _counted = connection;
            _last = now;
            _lastFrames = frames;
            _lastBytes = bytes;
        }

        private string Words(GatewayConnection connection)
        {
            GatewayClient client = connection.Client;
            _builder.Clear();
            _builder.Append(client.State.ToString().ToLowerInvariant());
            _builder.Append(' ').Append(client.Address);
            if (client.IsConnected)
            {
                Figure("\nround trip ", client.RosClock.RoundTripMilliseconds, "0.0", " ms");
                Figure("\n", MessagesPerSecond, "0", " messages/s, ");
                Figure("", KilobytesPerSecond, "0.0", " kB/s");
            }
            Figure("\ndropped ", client.MessagesDropped, "0", "");
            Figure(", pending requests ", client.PendingRequests, "0", "");
            return _builder.ToString();
        }

        private void Figure(string before, double value, string format, string after)
        {
            string figure = value.ToString(format, CultureInfo.InvariantCulture);
            _builder.Append(before).Append(figure).Append(after);
        }

        private Color ColorOf(ConnectionState state) =>
            state switch
            {
                ConnectionState.Connected => _connectedColor,
                ConnectionState.Refused => _refusedColor,
                ConnectionState.Disconnected => _disconnectedColor,
                _ => _waitingColor,
            };
    }
}
