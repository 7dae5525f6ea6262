// SPDX-License-Identifier: Apache-2.0
using System;
using System.Threading;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>
    /// A client of the gateway: topics, services, actions, parameters and the graph of ROS 2 over one WebSocket.
    /// </summary>
    /// <remarks>
    /// Frames are read on a background thread. Handlers and events are called by <see cref="Pump"/>, so
    /// on the application's own. Everything that was opened (subscriptions, publishers, services, watched
    /// graphs) is opened again after a reconnection. Everything that was asked is answered, if only by
    /// "connection lost". Methods may be called from any thread.
    /// </remarks>
    public sealed partial class GatewayClient : IDisposable
    {
        private const int TickMilliseconds = 50; // timeouts take seconds: this is soon enough
        private const int GoodbyeMilliseconds = 200; // a LAN takes one. A scene that ends must not hang

        private readonly GatewayOptions _options;
        private readonly Clock _clock = new Clock();
        private readonly Mailbox _mailbox = new Mailbox();
        private readonly Listeners<ConnectionState> _stateChanged;
        private readonly Outbox _outbox;
        private readonly Reports _reports;
        private readonly Subscriptions _subscriptions;
        private readonly Controls _controls;
        private readonly Publishers _publishers;
        private readonly Requests _requests;
        private readonly Goals _goals;
        private readonly ServiceProviders _providers;
        private readonly GraphWatch _graph;
        private readonly TransformWatches _transforms;
        private readonly Inbox _inbox;
        private readonly Link _link;
        private readonly Timer _timer;
        private long _names;
        private int _isStatePosted;
        private int _isDisposed;

        /// <summary>A client that is not connected yet. Topics can be opened before: they open with the connection.</summary>
        public GatewayClient(GatewayOptions options)
        {
            _options = options;
            RosClock = new ClockOffset(_clock);
            _stateChanged = new Listeners<ConnectionState>(_mailbox.ReportFault, "listener of StateChanged");
            _outbox = new Outbox(_clock, options.FreshMilliseconds);
            _reports = new Reports(_mailbox, _clock);
            _subscriptions = new Subscriptions(_outbox);
            _controls = new Controls(_outbox, _mailbox, _reports, _clock);
            _publishers = new Publishers(_outbox, _mailbox, _reports, _controls, _clock);
            _requests = new Requests(_outbox, _mailbox, _reports, _clock);
            _goals = new Goals(_outbox, _mailbox, _reports);
            _providers = new ServiceProviders(_outbox, _mailbox);
            _graph = new GraphWatch(_outbox, _mailbox);
            _transforms = new TransformWatches(_outbox, _clock);
            _inbox = new Inbox(
                _subscriptions, _publishers, _controls, _requests, _goals, _providers, _graph, _transforms, new Core(this),
                _reports);
            _link = new Link(options, new Core(this));
            if (options.UsesThreads)
            {
                _timer = new Timer(state => Tick(), null, TickMilliseconds, TickMilliseconds);
            }
        }

        /// <summary>The connection's state has changed. Called by <see cref="Pump"/>, with the newest.</summary>
        public event Action<ConnectionState> StateChanged
        {
            add { _stateChanged.Add(value); }
            remove { _stateChanged.Remove(value); }
        }

        /// <summary>
        /// Something that people should know: every refusal and warning of the gateway in its own words,
        /// and what went wrong on this side. Called by <see cref="Pump"/>.
        /// </summary>
        public event Action<GatewayEvent> EventHeard
        {
            add { _mailbox.Heard.Add(value); }
            remove { _mailbox.Heard.Remove(value); }
        }

        /// <summary>The address of the gateway. Another one counts from the next attempt to connect.</summary>
        public string Address
        {
            get { return _options.Address; }
            set { _options.Address = value; }
        }

        /// <summary>The token for the gateway, if it needs one. Like <see cref="Address"/>.</summary>
        public string Token
        {
            set { _options.Token = value; }
        }

        /// <summary>Whether it has ended for good.</summary>
        public bool IsDisposed
        {
            get { return Volatile.Read(ref _isDisposed) == 1; }
        }

        /// <summary>The state of the connection.</summary>
        public ConnectionState State
        {
            get { return _link.State; }
        }

        /// <summary>Whether frames flow.</summary>
        public bool IsConnected
        {
            get { return State == ConnectionState.Connected; }
        }

        /// <summary>ROS time, and how long a ping takes.</summary>
        public ClockOffset RosClock { get; private set; }

        /// <summary>How many frames have come, over all connections.</summary>
        public long FramesReceived { get; private set; }

        /// <summary>How many bytes have come, over all connections.</summary>
        public long BytesReceived { get; private set; }

        /// <summary>How many messages the application was too slow for, over all subscriptions.</summary>
        public long MessagesDropped
        {
            get { return _subscriptions.Dropped; }
        }

        /// <summary>How many requests and goals wait for their answers.</summary>
        public int PendingRequests
        {
            get { return _requests.Count + _goals.Count; }
        }

        /// <summary>The graph as it is. Null unless it is watched and has come.</summary>
        public RosGraph Graph
        {
            get { return _graph.Graph; }
        }

        /// <summary>Begins to connect, and keeps connecting until <see cref="Disconnect"/>.</summary>
        public void Connect()
        {
            _isSuspended = false;
            _link.Connect(_clock.Now);
        }

        /// <summary>
        /// Says goodbye once published messages have left, or after 0.2 s. Topics stay open, for the next
        /// <see cref="Connect"/>.
        /// </summary>
        public void Disconnect()
        {
            Leave(false);
        }

        /// <summary>
        /// Like <see cref="Disconnect"/>, for a while: who awaits <see cref="ConnectAsync"/> goes on waiting.
        /// </summary>
        internal void Suspend()
        {
            Leave(true);
        }

        private void Leave(bool isSuspended)
        {
            _isSuspended = isSuspended;
            if (_options.UsesThreads)
            {
                _outbox.WaitUntilEmpty(GoodbyeMilliseconds);
            }
            _link.Disconnect();
            _mailbox.Post("ConnectAsync", TellConnecting); // if it was suspended before, no change of state tells them
        }

        /// <summary>
        /// Disconnects for good, and no longer calls handlers. Awaited tasks fail. Returns when the goodbye is
        /// through, mostly at once, or after 0.4 s.
        /// </summary>
        public void Dispose()
        {
            if (Interlocked.Exchange(ref _isDisposed, 1) == 1)
            {
                return;
            }
            if (_timer != null)
            {
                _timer.Dispose();
            }
            Disconnect();
            _link.Close(GoodbyeMilliseconds);
            _mailbox.Close();
            _awaited.Close();
        }

        /// <summary>
        /// Calls what waits: answers and events, then messages, each subscription in turn, until nothing
        /// waits or the time is up. Call it once per frame of the application, always on one thread.
        /// </summary>
        /// <returns>How many messages were handed to handlers.</returns>
        public int Pump(double budgetMilliseconds = 4)
        {
            _link.Poll();
            if (!_options.UsesThreads)
            {
                Tick();
            }
            return _mailbox.Pump(budgetMilliseconds);
        }

        /// <summary>Subscribes to a topic whose messages are of type T.</summary>
        /// <param name="handler">Called by <see cref="Pump"/>. Null to take messages from the subscription.</param>
        /// <param name="reuse">Whether messages, and their arrays where the length stays, are filled again. Each is
        /// the handler's until the next one is handed out, and what it lacks is as in an earlier one.</param>
        public Subscription<T> Subscribe<T>(
            string topic, Action<T> handler = null, SubscribeOptions options = null, bool reuse = false)
            where T : IMessage, new()
        {
            return Subscribe(topic, new T().RosType, () => new T(), handler, options, null, reuse);
        }

        /// <summary>Subscribes to a topic of a type that is known only at run time.</summary>
        /// <param name="type">pkg/msg/Name, or empty to let the gateway find it out.</param>
        /// <param name="create">Makes an empty message, on the thread that reads frames.</param>
        /// <param name="prepare">Called with each message on the thread that reads frames, before it waits for
        /// the handler. All topics wait in the meantime: what takes long belongs to another thread.</param>
        /// <param name="reuse">Whether messages are filled again. See the other.</param>
        public Subscription<T> Subscribe<T>(
            string topic, string type, Func<T> create, Action<T> handler = null, SubscribeOptions options = null,
            Action<T> prepare = null, bool reuse = false)
            where T : IMessage
        {
            options = options ?? new SubscribeOptions();
            string name = Names.Absolute(topic);
            string reason = options.Queue <= 1 ? ""
                : "more than " + options.Queue + " waited for the application: take them faster, or subscribe with a"
                + " longer Queue";
            Subscription<T> subscription = new Subscription<T>(
                _subscriptions, _mailbox, new Drops(_mailbox, _reports, "subscribe", name, reason), NewId("s"), name,
                type ?? "", options, create, handler, prepare, reuse);
            _subscriptions.Add(subscription);
            return subscription;
        }

        /// <summary>Advertises a topic whose messages are of type T.</summary>
        public Publisher<T> Advertise<T>(string topic, AdvertiseOptions options = null)
            where T : IMessage, new()
        {
            Publisher<T> publisher = new Publisher<T>(
                _publishers, NewId("p"), Names.Absolute(topic), new T().RosType, options ?? new AdvertiseOptions());
            _publishers.Add(publisher);
            return publisher;
        }

        /// <summary>Advertises a topic of a type that is known only at run time, pkg/msg/Name.</summary>
        public Publisher Advertise(string topic, string type, AdvertiseOptions options = null)
        {
            Publisher publisher = new Publisher(
                _publishers, NewId("p"), Names.Absolute(topic), type, options ?? new AdvertiseOptions());
            _publishers.Add(publisher);
            return publisher;
        }

        /// <summary>
        /// Watches who drives the robot behind a command topic and whether it may be driven. By what this returns
        /// it is stopped, and control taken.
        /// </summary>
        /// <param name="changed">Called by <see cref="Pump"/> with each change. Null for none.</param>
        public RobotControl Control(string topic = "/cmd_vel", Action<ControlState> changed = null)
        {
            RobotControl control = new RobotControl(_controls, _requests, Names.Absolute(topic), _options.CallMilliseconds);
            if (changed != null)
            {
                control.Changed += changed;
            }
            return control;
        }

        /// <summary>Stops every robot of the gateway, even if another client drives. Any client may.</summary>
        /// <param name="done">Gets the command topics that are stopped.</param>
        public void StopRobots(Action<Reply<string[]>> done = null)
        {
            RobotControl.Stop(_controls, _requests, null, done, _options.CallMilliseconds);
        }

        /// <summary>Calls a service. *Done* is called by <see cref="Pump"/>, once, whatever happens.</summary>
        /// <param name="timeoutMilliseconds">0 for <see cref="GatewayOptions.CallMilliseconds"/>.</param>
        public void CallService<TResponse>(
            string service, IMessage request, Action<Reply<TResponse>> done, int timeoutMilliseconds = 0)
            where TResponse : IMessage, new()
        {
            SendCall(Names.Absolute(service), request, done, timeoutMilliseconds);
        }

        /// <summary>Provides a ROS service. The handler is called by <see cref="Pump"/>.</summary>
        /// <param name="type">pkg/srv/Name: the constant Service of the request's class.</param>
        public ServiceProvider AdvertiseService<TRequest, TResponse>(
            string service, string type, Func<TRequest, TResponse> handler)
            where TRequest : IMessage, new()
            where TResponse : IMessage
        {
            ServiceProvider provider = new ServiceProvider<TRequest, TResponse>(
                _providers, Names.Absolute(service), type, handler);
            _providers.Add(provider);
            return provider;
        }

        /// <summary>Sends a goal to an action server. *onResult* is called once, whatever happens.</summary>
        /// <param name="onFeedback">Called with the newest feedback. Null if none is wanted.</param>
        /// <param name="keep">Whether the goal goes on when this client leaves. Else it is cancelled then.</param>
        public Goal SendGoal<TFeedback, TResult>(
            string action, IMessage goal, Action<TFeedback> onFeedback, Action<GoalResult<TResult>> onResult,
            bool keep = false)
            where TFeedback : IMessage, new()
            where TResult : IMessage, new()
        {
            return _goals.Send(Names.Absolute(action), goal, onFeedback, onResult, keep);
        }

        /// <summary>
        /// Asks for anything else that the gateway knows, such as "describe" or "lookup_transform". The
        /// reply is the whole frame of the answer.
        /// </summary>
        /// <param name="members">The members of the operation. Null for none.</param>
        public void Request(
            string op, JsonValue members, Action<Reply<JsonValue>> done, int timeoutMilliseconds = 0)
        {
            SendRequest(op, members, JsonValue.Read, done, timeoutMilliseconds);
        }

        /// <summary>Calls *watcher* with the graph, now and whenever it changes.</summary>
        public void WatchGraph(Action<RosGraph> watcher)
        {
            _graph.Add(watcher);
        }

        /// <summary>Ends that.</summary>
        public void UnwatchGraph(Action<RosGraph> watcher)
        {
            _graph.Remove(watcher);
        }

        /// <summary>
        /// Watches where a frame is in another, by the transforms that the gateway hears. A gateway takes 16
        /// watches of a client unless it is configured otherwise.
        /// </summary>
        /// <param name="rateHz">How often the pose may come. 200 at most.</param>
        public TransformWatch WatchTransform(string targetFrame, string sourceFrame, double rateHz = 30)
        {
            return _transforms.Add(NewId("t"), targetFrame, sourceFrame, rateHz);
        }

        /// <summary>Tells of an exception of a handler of the application's. See <see cref="Listeners{T}"/>.</summary>
        internal void ReportFault(string where, Exception error, long times)
        {
            _mailbox.ReportFault(where, error, times);
        }

        private string SendCall<TResponse>(
            string name, IMessage request, Action<Reply<TResponse>> done, int timeoutMilliseconds, bool isAwaited = false)
            where TResponse : IMessage, new()
        {
            int timeout = timeoutMilliseconds > 0 ? timeoutMilliseconds : _options.CallMilliseconds;
            return _requests.Send(
                "call_service",
                "call_service " + name,
                frame =>
                {
                    frame.Member("service", name);
                    Names.WriteArguments(frame, request, "request", "type", "_Request");
                    frame.Member("nonfinite", "string");
                    frame.Member("timeout", timeout / 1000.0);
                },
                reader =>
                {
                    TResponse response = new TResponse();
                    response.Read(reader);
                    return response;
                },
                done,
                timeout,
                isAwaited);
        }

        private string SendRequest<T>(
            string op, JsonValue members, Func<JsonReader, T> read, Action<Reply<T>> done, int timeoutMilliseconds,
            bool isAwaited = false)
        {
            return _requests.Send(
                op,
                op,
                frame => WriteMembers(frame, members),
                read,
                done,
                timeoutMilliseconds > 0 ? timeoutMilliseconds : _options.CallMilliseconds,
                isAwaited);
        }

        private static void WriteMembers(JsonWriter frame, JsonValue members)
        {
            if (members == null)
            {
                return;
            }
            foreach (string name in members.Names)
            {
                frame.Name(name);
                members[name].Write(frame);
            }
        }

        private string NewId(string kind)
        {
            return kind + Interlocked.Increment(ref _names);
        }

        private void Tick()
        {
            if (_isDisposed == 1)
            {
                return;
            }
            long now = _clock.Now;
            _link.Tick(now);
            _requests.Tick(now);
            _publishers.Tick(now);
            _transforms.Tick(now);
            MissPump(now);
            if (_outbox.IsPingDue(now))
            {
                SendPing();
            }
            _outbox.Flush(); // for a transport that was busy and has no way to say that it no longer is
        }

        private void PostState()
        {
            if (Interlocked.Exchange(ref _isStatePosted, 1) == 0)
            {
                _mailbox.Post("StateChanged", TellState);
            }
        }

        private void TellState()
        {
            Volatile.Write(ref _isStatePosted, 0);
            TellConnecting();
            _stateChanged.Call(State);
        }

        private void Up(ITransport transport)
        {
            _outbox.Attach(transport);
            if (!string.IsNullOrEmpty(_options.Token))
            {
                JsonWriter frame = _outbox.Rent();
                frame.Begin("auth");
                frame.Member("token", _options.Token);
                frame.EndObject();
                _outbox.Post(frame);
            }
            Post("hello");
            _publishers.Restore();
            _controls.Restore();
            _providers.Restore();
            _outbox.OpenQueues();
            _subscriptions.Restore();
            _graph.Restore();
            _transforms.Restore();
        }

        private void Down(string errorText)
        {
            _outbox.Detach();
            RosClock.Forget();
            _isGreeted = false;
            _providers.OnDown();
            _controls.OnDown();
            _transforms.OnDown();
            _requests.FailAll(errorText);
            _goals.FailAll(errorText);
        }

        private void SendPing()
        {
            JsonWriter frame = _outbox.Rent();
            frame.Begin("ping");
            frame.Member("value", _clock.Precise);
            frame.EndObject();
            _outbox.OnPing(_clock.Now);
            _outbox.Post(frame);
        }

        private void Post(string op)
        {
            JsonWriter frame = _outbox.Rent();
            frame.Begin(op);
            frame.EndObject();
            _outbox.Post(frame);
        }

        /// <summary>The calls of the parts to the client, so that they are not public.</summary>
        private sealed class Core : ILinkOwner, IInboxOwner
        {
            private readonly GatewayClient _client;

            internal Core(GatewayClient client)
            {
                _client = client;
            }

            public void OnUp(ITransport transport)
            {
                _client.Up(transport);
            }

            public void OnFrame(byte[] buffer, int count)
            {
                _client.FramesReceived++;
                _client.BytesReceived += count;
                try
                {
                    _client._inbox.Read(buffer, count);
                }
                catch (Exception error)
                {
                    // A fault of this client, not of the frame: told, and no reason to stop reading.
                    _client._mailbox.Report(new GatewayEvent(
                        EventLevel.Error, "a frame could not be handled: " + error.Message, "internal", "", error));
                }
            }

            public void OnSent(ITransport transport)
            {
                _client._outbox.OnSent(transport);
            }

            public void OnHeartbeat()
            {
                _client.SendPing();
            }

            public void OnDown(string errorText)
            {
                _client.Down(errorText);
            }

            public void OnPong(double sent, double rosSeconds)
            {
                _client._outbox.OnPong();
                _client._link.Praise();
                if (!double.IsNaN(sent))
                {
                    _client._publishers.OnPong(sent);
                    _client.RosClock.Add(sent, rosSeconds);
                }
            }

            public void OnHello(JsonValue hello)
            {
                long bytes = hello["limits"]["message_bytes"].AsLong(int.MaxValue);
                _client._outbox.MaxFrameBytes = (int)Math.Min(bytes, int.MaxValue);
                _client.Greeted();
            }

            public void OnState(ConnectionState state)
            {
                _client.PostState();
            }

            public void Report(EventLevel level, string text)
            {
                _client._reports.Tell(level, text, "client", "");
            }

            public void OnRefused(string text)
            {
                _client._reports.Failure("", text, Volatile.Read(ref _client._connects) > 0);
            }
        }
    }
}
