// SPDX-License-Identifier: Apache-2.0
using System;
using System.Threading;

namespace Ros2Gateway
{
    /// <summary>The calls of a link to its client. On any thread, never two at once for one connection.</summary>
    internal interface ILinkOwner
    {
        /// <summary>A connection stands: restore what was open. Within the link's lock, as is OnDown.</summary>
        void OnUp(ITransport transport);

        void OnFrame(byte[] buffer, int count);

        void OnSent(ITransport transport);

        void OnHeartbeat();

        void OnDown(string errorText);

        void OnState(ConnectionState state);

        void Report(EventLevel level, string text);

        /// <summary>The client will not try again. Called before the state says so.</summary>
        void OnRefused(string text);
    }

    /// <summary>Keeps a connection: connects, notices silence, waits, connects again.</summary>
    /// <remarks>Time comes as an argument, in milliseconds of a clock that never goes back.</remarks>
    internal sealed class Link
    {
        // Close codes by which the gateway says that trying again does not help: not authenticated, role removed.
        private const int Unauthenticated = 4401;
        private const int RoleRemoved = 4403;
        private const int Normal = 1000; // RFC 6455, 7.4.1

        // A server that accepts and stays silent costs a socket with each attempt, which .NET cannot take back. After
        // so many in a row, a quarter of an hour, they become rare, 60 in an hour. Whether it accepted is not
        // told, so a robot that is out of reach counts like that as well.
        private const int ManyAttempts = 120;
        private const double SilentPauseMilliseconds = 60000;

        // A transport that gives up by its own clock may do so between two ticks.
        private const long TickMilliseconds = 500;

        // Ticks come every 50 ms or every frame. After a longer gap it was this program that slept (a
        // breakpoint, a headset put down), and what the gateway said in the meantime has yet to be read.
        private const int SleptMilliseconds = 1000;

        private readonly object _gate = new();
        private readonly GatewayOptions _options;
        private readonly ILinkOwner _owner;
        private readonly Random _random = new();
        private Attempt _attempt;
        private long _now;
        private long _attemptBegan;
        private long _nextAttempt;
        private long _lastFrame;
        private long _nextHeartbeat;
        private double _pause;
        private int _silentAttempts; // one after the other
        private bool _isClosed;
        private Attempt _leaving; // the last that was said goodbye to
        private volatile string _lastError;

        internal Link(GatewayOptions options, ILinkOwner owner)
        {
            _options = options;
            _owner = owner;
        }

        internal ConnectionState State { get; private set; }

        /// <summary>Why it is not connected, in words. Null while nothing has failed.</summary>
        internal string LastError => _lastError;

        internal void Connect(long now)
        {
            lock (_gate)
            {
                _now = now;
                if (_isClosed || (State != ConnectionState.Disconnected && State != ConnectionState.Refused))
                {
                    return;
                }
                _pause = _options.FirstPauseMilliseconds;
                _silentAttempts = 0;
                _lastError = null;
                Begin();
            }
        }

        /// <summary>Says goodbye and tries no longer.</summary>
        internal void Disconnect()
        {
            Attempt attempt;
            lock (_gate)
            {
                if (State == ConnectionState.Disconnected)
                {
                    return;
                }
                attempt = _attempt;
                _attempt = null;
                _leaving = attempt ?? _leaving;
                _owner.OnDown("disconnected");
                Become(ConnectionState.Disconnected);
            }
            if (attempt != null)
            {
                attempt.Transport.Close(Normal, "");
                if (!_options.UsesThreads)
                {
                    attempt.Transport.Dispose(); // nobody will poll it to its end
                }
            }
        }

        /// <summary>Disconnects for good, and waits so long for the goodbye to be through.</summary>
        internal void Close(int waitMilliseconds)
        {
            lock (_gate)
            {
                _isClosed = true;
            }
            Disconnect();
            Attempt leaving = _leaving;
            if (leaving != null && _options.UsesThreads)
            {
                leaving.Closed.Wait(waitMilliseconds);
            }
        }

        /// <summary>The gateway answers: a loss that comes now is a new one, with the shortest pause.</summary>
        internal void Praise()
        {
            lock (_gate)
            {
                _pause = _options.FirstPauseMilliseconds;
            }
        }

        /// <summary>Lets a transport without threads call back.</summary>
        internal void Poll()
        {
            Attempt attempt;
            lock (_gate)
            {
                attempt = _attempt;
            }
            attempt?.Transport.Poll();
        }

        /// <summary>Does what is due. As often as one likes, twenty times a second is plenty.</summary>
        internal void Tick(long now)
        {
            bool isHeartbeatDue = false;
            Attempt silent = null;
            string errorText = null;
            lock (_gate)
            {
                if (now - _now > SleptMilliseconds)
                {
                    _lastFrame = now;
                }
                _now = now;
                switch (State)
                {
                    case ConnectionState.Waiting:
                        if (now >= _nextAttempt)
                        {
                            Begin();
                        }
                        break;
                    case ConnectionState.Connecting:
                        // The transport keeps this deadline itself, mostly. Twice as long and it is forgotten.
                        if (now - _attemptBegan > 2 * _options.ConnectMilliseconds)
                        {
                            silent = _attempt;
                            errorText = "no answer within " + 2 * _options.ConnectMilliseconds + " ms";
                        }
                        break;
                    case ConnectionState.Connected:
                        if (now - _lastFrame > _options.SilenceMilliseconds)
                        {
                            silent = _attempt;
                            errorText = "no word from the gateway for " + _options.SilenceMilliseconds + " ms";
                        }
                        else if (now >= _nextHeartbeat)
                        {
                            _nextHeartbeat = now + _options.HeartbeatMilliseconds;
                            isHeartbeatDue = true;
                        }
                        break;
                }
            }
            if (silent != null)
            {
                Ended(silent, 0, errorText);
                silent.Transport.Dispose();
            }
            else if (isHeartbeatDue)
            {
                _owner.OnHeartbeat();
            }
        }

        private void Begin()
        {
            if (!Uri.TryCreate(_options.Address, UriKind.Absolute, out Uri address)
                || (address.Scheme != "ws" && address.Scheme != "wss"))
            {
                _lastError = "address '" + _options.Address + "': expected ws://HOST:PORT or wss://HOST:PORT";
                _owner.OnRefused(_lastError);
                Become(ConnectionState.Refused);
                return;
            }
            _attemptBegan = _now;
            Become(ConnectionState.Connecting);
            try
            {
                _attempt = new Attempt(this, _options.NewTransport());
                _attempt.Transport.Open(WithWarnings(address), _attempt);
            }
            catch (Exception error)
            {
                // A transport of the application's own may throw. It must not throw on this thread.
                End(0, error.Message);
            }
        }

        /// <summary>Asks the gateway for warnings, which it sends to no client of rosbridge.</summary>
        private static Uri WithWarnings(Uri address)
        {
            // the option of the application's own address is the last one, which counts
            string own = address.Query.TrimStart('?');
            return new UriBuilder(address) { Query = "status=warning" + (own.Length > 0 ? "&" + own : "") }.Uri;
        }

        private void Become(ConnectionState state)
        {
            State = state;
            _owner.OnState(state);
        }

        private void Opened(Attempt attempt)
        {
            lock (_gate)
            {
                if (attempt != _attempt)
                {
                    return;
                }
                _lastFrame = _now;
                _nextHeartbeat = _now;
                _lastError = null;
                _silentAttempts = 0;
                _owner.OnUp(attempt.Transport);
                if (attempt != _attempt)
                {
                    return; // it ended in the first frame that was sent
                }
                Become(ConnectionState.Connected);
                _owner.Report(EventLevel.Info, "connected to " + _options.Address);
            }
        }

        private bool IsCurrent(Attempt attempt)
        {
            if (attempt != _attempt)
            {
                return false;
            }
            _lastFrame = _now; // of the last tick, which is near enough for seconds
            return true;
        }

        private void Ended(Attempt attempt, int code, string reason)
        {
            lock (_gate)
            {
                if (attempt == _attempt)
                {
                    End(code, reason);
                }
            }
        }

        private void End(int code, string reason)
        {
            bool wasUp = State == ConnectionState.Connected;
            bool isRefused = code == Unauthenticated || code == RoleRemoved;
            string errorText = (wasUp ? "connection to " : "cannot connect to ") + _options.Address
                + (wasUp ? " lost" : "") + Because(code, reason);
            _attempt = null;
            // Clients that lost the same gateway should not all come back in the same moment.
            double pause = _pause * (0.8 + 0.4 * _random.NextDouble());
            _nextAttempt = _now + (long)pause;
            bool wasSilent = !wasUp && _now - _attemptBegan >= _options.ConnectMilliseconds - TickMilliseconds;
            _silentAttempts = wasSilent ? _silentAttempts + 1 : 0;
            _pause = Math.Min(
                2 * _pause,
                _silentAttempts > ManyAttempts ? SilentPauseMilliseconds : _options.LongestPauseMilliseconds);
            _owner.OnDown(errorText);
            // An absent gateway is told once, not with every attempt.
            bool isNews = errorText != _lastError;
            _lastError = errorText;
            if (isNews && isRefused)
            {
                _owner.OnRefused(errorText);
            }
            Become(isRefused ? ConnectionState.Refused : ConnectionState.Waiting);
            if (isNews && !isRefused)
            {
                _owner.Report(EventLevel.Error, errorText + ", trying again");
            }
        }

        private static string Because(int code, string reason)
        {
            if (!string.IsNullOrEmpty(reason))
            {
                return code == 0 ? ": " + reason : ": " + reason + " (" + code + ")";
            }
            return code == 0 ? "" : " (" + code + ")";
        }

        /// <summary>One transport. The words of an abandoned one are ignored.</summary>
        private sealed class Attempt : ITransportListener
        {
            internal readonly ITransport Transport;
            internal readonly ManualResetEventSlim Closed = new();
            private readonly Link _link;

            internal Attempt(Link link, ITransport transport)
            {
                _link = link;
                Transport = transport;
            }

            public void OnOpen() => _link.Opened(this);

            public void OnProgress() => _link.IsCurrent(this);

            public void OnFrame(byte[] buffer, int count)
            {
                if (_link.IsCurrent(this))
                {
                    _link._owner.OnFrame(buffer, count);
                }
            }

            public void OnOversized(long bytes)
            {
                if (_link.IsCurrent(this))
                {
                    _link._owner.Report(
                        EventLevel.Error,
                        "a message of " + bytes + " bytes was skipped, at most "
                        + _link._options.MaxMessageBytes + " are read");
                }
            }

            public void OnSent() => _link._owner.OnSent(Transport);

            public void OnClosed(int code, string reason)
            {
                Closed.Set();
                _link.Ended(this, code, reason);
            }
        }
    }
}
