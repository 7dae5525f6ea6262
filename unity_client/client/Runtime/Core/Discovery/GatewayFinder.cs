// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Diagnostics;
using System.Net;
using System.Net.Sockets;
using System.Text;

namespace Ros2Gateway
{
    /// <summary>
    /// Looks for gateways on this network, from its creation until it is disposed of. Call <see cref="Pump"/> in
    /// every frame. It uses no thread. Browsers cannot do this, see <see cref="Problem"/>.
    /// </summary>
    public sealed class GatewayFinder : IDisposable
    {
        /// <summary>The UDP port on which gateways listen for this question.</summary>
        public const int Port = 9090;

        private const int AskMilliseconds = 500; // a datagram may be lost
        private const int QuestionBytes = 512; // gateways answer none that is shorter than their answer
        private const int MaxBytes = 1400;
        private const int MaxFound = 256;
        private const int MaxPerPump = 32;

        private readonly List<FoundGateway> _found = new();
        private readonly IPAddress[] _targets;
        private readonly byte[] _question =
            Encoding.ASCII.GetBytes("{\"op\":\"find_gateways\"}".PadRight(QuestionBytes));
        private readonly byte[] _datagram = new byte[MaxBytes];
        private readonly Stopwatch _watch = Stopwatch.StartNew();
        private readonly Socket _socket;
        private long _nextAsk;
        private bool _isClosed;

        /// <summary>Begins.</summary>
        /// <param name="targets">Broadcast addresses. By default that of the network which the system prefers,
        /// and this machine's own. A machine in several networks names each, such as 192.168.1.255.</param>
        public GatewayFinder(params IPAddress[] targets)
        {
            _targets = targets.Length > 0 ? targets : new[] { IPAddress.Broadcast, IPAddress.Parse("127.255.255.255") };
#if UNITY_WEBGL && !UNITY_EDITOR
            _socket = null;
            _isClosed = true;
            Problem = "browsers cannot look for gateways: enter the address";
#else
            try
            {
                _socket = new Socket(AddressFamily.InterNetwork, SocketType.Dgram, ProtocolType.Udp)
                {
                    Blocking = false,
                    EnableBroadcast = true,
                };
                _socket.Bind(new IPEndPoint(IPAddress.Any, 0));
            }
            catch (SocketException error)
            {
                Dispose();
                Problem = "cannot look for gateways: " + error.Message;
            }
#endif
        }

        /// <summary>The gateways that have answered, in the order in which they did.</summary>
        public IReadOnlyList<FoundGateway> Found => _found;

        /// <summary>Why nobody can be asked at the moment, or null.</summary>
        public string Problem { get; private set; }

        /// <summary>Asks again when it is time, and takes the answers that have come.</summary>
        public void Pump()
        {
            if (_isClosed)
            {
                return;
            }
            if (_watch.ElapsedMilliseconds >= _nextAsk)
            {
                _nextAsk = _watch.ElapsedMilliseconds + AskMilliseconds;
                Ask();
            }
            for (int i = 0; i < MaxPerPump && TakeOne(); i++)
            {
            }
        }

        /// <summary>Looks no longer. Found gateways stay.</summary>
        public void Dispose()
        {
            _isClosed = true;
            _socket?.Close();
        }

        /// <summary>Lists a gateway, unless it is null or listed already.</summary>
        internal void Add(FoundGateway gateway)
        {
            if (gateway == null)
            {
                return;
            }
            int known = _found.FindIndex(
                each => each.Id == gateway.Id && (IsHere(each) || IsHere(gateway) || each.Address == gateway.Address));
            if (known < 0 && _found.Count < MaxFound)
            {
                _found.Add(gateway);
            }
            else if (known >= 0 && IsHere(_found[known]))
            {
                _found[known] = gateway;
            }
        }

        // a gateway of this machine is heard at this address as well, which other machines cannot use
        private static bool IsHere(FoundGateway gateway) => gateway.Address.Contains("://127.");

        private void Ask()
        {
            bool isAsked = false;
            string problem = null;
            foreach (IPAddress target in _targets)
            {
                try
                {
                    _socket.SendTo(_question, new IPEndPoint(target, Port));
                    isAsked = true;
                }
                catch (SocketException error)
                {
                    problem = "cannot look for gateways: " + error.Message;
                }
            }
            Problem = isAsked ? null : problem;
        }

        private bool TakeOne()
        {
            EndPoint sender = new IPEndPoint(IPAddress.Any, 0);
            int count;
            try
            {
                if (!_socket.Poll(0, SelectMode.SelectRead)) // Available is 0 for an empty datagram as well
                {
                    return false;
                }
                count = _socket.ReceiveFrom(_datagram, ref sender);
            }
            catch (SocketException)
            {
                return true; // too long for an answer. Or Windows reports one that was not delivered
            }
            Add(FoundGateway.Read(_datagram, count, ((IPEndPoint)sender).Address));
            return true;
        }
    }
}
