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
    public sealed partial class GatewayClient : IDisposable, ILinkOwner
    {
        private const int TickMilliseconds = 50; // timeouts take seconds: this is soon enough
        private const int GoodbyeMilliseconds = 200; // a LAN takes one. A scene that ends must not hang

        private readonly GatewayOptions _options;
        private readonly Listeners<ConnectionState> _stateChanged;
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
            RosClock = new ClockOffset(Clock);
            _stateChanged = new Listeners<ConnectionState>(Mailbox.ReportFault, "listener of StateChanged");
            Outbox = new Outbox(Clock, options.FreshMilliseconds);
            Reports = new Reports(Mailbox, Clock);
            Subscriptions = new Subscriptions(Outbox);
            Publishers = new Publishers(this);
            Requests = new Requests(this);
            Goals = new Goals(this);
            Providers = new ServiceProviders(this);
            GraphWatch = new GraphWatch(this);
            Transforms = new TransformWatches(this);
            _inbox = new Inbox(this);
            _link = new Link(options, this);
            if (options.UsesThreads)
            {
                _timer = new Timer(state => Tick(), null, TickMilliseconds, TickMilliseconds);
            }
        }

        /// <summary>The connection's state has changed. Called by <see cref="Pump"/>, with the newest.</summary>
        public event Action<ConnectionState> StateChanged
        {
            add => _stateChanged.Add(value);
            remove => _stateChanged.Remove(value);
        }

        /// <summary>
        /// Something that people should know: every refusal and warning of the gateway in its own words,
        /// and what went wrong on this side. Called by <see cref="Pump"/>.
        /// </summary>
        public event Action<GatewayEvent> EventHeard
        {
            add => Mailbox.Heard.Add(value);
            remove => Mailbox.Heard.Remove(value);
        }

        /// <summary>The address of the gateway. Another one counts from the next attempt to connect.</summary>
        public string Address
        {
            get => _options.Address;
            set => _options.Address = value;
        }

        /// <summary>The token for the gateway, if it needs one. Like <see cref="Address"/>.</summary>
        public string Token
        {
            set => _options.Token = value;
        }

        /// <summary>Whether it has ended for good.</summary>
        public bool IsDisposed => Volatile.Read(ref _isDisposed) == 1;

        /// <summary>The state of the connection.</summary>
        public ConnectionState State => _link.State;

        /// <summary>Whether frames flow.</summary>
        public bool IsConnected => State == ConnectionState.Connected;

        /// <summary>ROS time, and how long a ping takes.</summary>
        public ClockOffset RosClock { get; private set; }

        /// <summary>How many frames have come, over all connections.</summary>
        public long FramesReceived { get; private set; }

        /// <summary>How many bytes have come, over all connections.</summary>
        public long BytesReceived { get; private set; }

        /// <summary>How many messages the application was too slow for, over all subscriptions.</summary>
        public long MessagesDropped => Subscriptions.Dropped;

        /// <summary>How many requests and goals wait for their answers.</summary>
        public int PendingRequests => Requests.Count + Goals.Count;

        /// <summary>The graph as it is. Null unless it is watched and has come.</summary>
        public RosGraph Graph => GraphWatch.Graph;

        internal Clock Clock { get; } = new();

        internal Mailbox Mailbox { get; } = new();

        internal Outbox Outbox { get; }

        internal Reports Reports { get; }

        internal Publishers Publishers { get; }

        internal Requests Requests { get; }

        internal Subscriptions Subscriptions { get; }

        internal Goals Goals { get; }

        internal ServiceProviders Providers { get; }

        internal GraphWatch GraphWatch { get; }

        internal TransformWatches Transforms { get; }

        internal int CallMilliseconds => _options.CallMilliseconds;

        /// <summary>How many connections there have been.</summary>
        internal int Connections { get; private set; }

        /// <summary>Begins to connect, and keeps connecting until <see cref="Disconnect"/>.</summary>
        public void Connect()
        {
            _isSuspended = false;
            _link.Connect(Clock.Now);
        }

        /// <summary>
        /// Says goodbye once published messages have left, or after 0.2 s. Topics stay open, for the next
        /// <see cref="Connect"/>.
        /// </summary>
        public void Disconnect() => Leave(false);

        /// <summary>
        /// Like <see cref="Disconnect"/>, for a while: who awaits <see cref="ConnectAsync"/> goes on waiting.
        /// </summary>
        internal void Suspend() => Leave(true);

        private void Leave(bool isSuspended)
        {
            _isSuspended = isSuspended;
            if (_options.UsesThreads)
            {
                Outbox.WaitUntilEmpty(GoodbyeMilliseconds);
            }
            _link.Disconnect();
            Mailbox.Post("ConnectAsync", TellConnecting); // if it was suspended before, no change of state tells them
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
            _timer?.Dispose();
            Disconnect();
            _link.Close(GoodbyeMilliseconds);
            Mailbox.Close();
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
            return Mailbox.Pump(budgetMilliseconds);
        }

        /// <summary>Subscribes to a topic whose messages are of type T.</summary>
        /// <param name="handler">Called by <see cref="Pump"/>. Null to take messages from the subscription.</param>
        /// <param name="reuse">Whether messages, and their arrays where the length stays, are filled again. Each is
        /// the handler's until the next one is handed out, and what it lacks is as in an earlier one.</param>
        public Subscription<T> Subscribe<T>(
            string topic, Action<T> handler = null, SubscribeOptions options = null, bool reuse = false)
            where T : IMessage, new() =>
            Subscribe(topic, new T().RosType, () => new T(), handler, options, null, reuse);

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
            options ??= new SubscribeOptions();
            string name = Names.Absolute(topic);
            string reason = options.Queue <= 1 ? ""
                : "more than " + options.Queue + " waited for the application: take them faster, or subscribe with a"
                + " longer Queue";
            Subscription<T> subscription = new(
                Subscriptions, Mailbox, new Drops(this, "subscribe", name, reason), NewId("s"), name,
                type ?? "", options, create, handler, prepare, reuse);
            Subscriptions.Add(subscription);
            return subscription;
        }

        /// <summary>Advertises a topic whose messages are of type T.</summary>
        public Publisher<T> Advertise<T>(string topic, AdvertiseOptions options = null)
            where T : IMessage, new()
        {
            Publisher<T> publisher = new(
                Publishers, NewId("p"), Names.Absolute(topic), new T().RosType, options ?? new AdvertiseOptions());
            Publishers.Add(publisher);
            return publisher;
        }

        /// <summary>Advertises a topic of a type that is known only at run time, pkg/msg/Name.</summary>
        public Publisher Advertise(string topic, string type, AdvertiseOptions options = null)
        {
            Publisher publisher = new(
                Publishers, NewId("p"), Names.Absolute(topic), type, options ?? new AdvertiseOptions());
            Publishers.Add(publisher);
            return publisher;
        }

        /// <summary>Calls a service. *Done* is called by <see cref="Pump"/>, once, whatever happens.</summary>
        /// <param name="timeoutMilliseconds">0 for <see cref="GatewayOptions.CallMilliseconds"/>.</param>
        public void CallService<TResponse>(
            string service, IMessage request, Action<Reply<TResponse>> done, int timeoutMilliseconds = 0)
            where TResponse : IMessage, new() =>
            SendCall(Names.Absolute(service), request, done, timeoutMilliseconds);

        /// <summary>Provides a ROS service. The handler is called by <see cref="Pump"/>.</summary>
        /// <param name="type">pkg/srv/Name: the constant Service of the request's class.</param>
        public ServiceProvider AdvertiseService<TRequest, TResponse>(
            string service, string type, Func<TRequest, TResponse> handler)
            where TRequest : IMessage, new()
            where TResponse : IMessage
        {
            ServiceProvider provider = new(Providers, Names.Absolute(service), type, reader =>
            {
                TRequest request = new();
                request.Read(reader);
                return () => handler(request);
            });
            Providers.Add(provider);
            return provider;
        }

        /// <summary>Sends a goal to an action server. *onResult* is called once, whatever happens.</summary>
        /// <param name="onFeedback">Called with the newest feedback. Null if none is wanted.</param>
        /// <param name="keep">Whether the goal goes on when this client leaves. Else it is cancelled then.</param>
        public Goal SendGoal<TFeedback, TResult>(
            string action, IMessage goal, Action<TFeedback> onFeedback, Action<GoalResult<TResult>> onResult,
            bool keep = false)
            where TFeedback : IMessage, new()
            where TResult : IMessage, new() =>
            Goals.Send(Names.Absolute(action), goal, onFeedback, onResult, keep);

        /// <summary>
        /// Asks for anything else that the gateway knows, such as "describe" or "lookup_transform". The
        /// reply is the whole frame of the answer.
        /// </summary>
        /// <param name="members">The members of the operation. Null for none.</param>
        public void Request(
            string op, JsonValue members, Action<Reply<JsonValue>> done, int timeoutMilliseconds = 0) =>
            SendRequest(op, members, JsonValue.Read, done, timeoutMilliseconds);

        /// <summary>Calls *watcher* with the graph, now and whenever it changes.</summary>
        public void WatchGraph(Action<RosGraph> watcher) => GraphWatch.Add(watcher);

        /// <summary>Ends that.</summary>
        public void UnwatchGraph(Action<RosGraph> watcher) => GraphWatch.Remove(watcher);

        /// <summary>
        /// Watches where a frame is in another, by the transforms that the gateway hears. A gateway takes 16
        /// watches of a client unless it is configured otherwise.
        /// </summary>
        /// <param name="rateHz">How often the pose may come. 200 at most.</param>
        public TransformWatch WatchTransform(string targetFrame, string sourceFrame, double rateHz = 30) =>
            Transforms.Add(NewId("t"), targetFrame, sourceFrame, rateHz);

        /// <summary>Tells of an exception of a handler of the application's. See <see cref="Listeners{T}"/>.</summary>
        internal void ReportFault(string where, Exception error, long times) => Mailbox.ReportFault(where, error, times);

        private string SendCall<TResponse>(
            string name, IMessage request, Action<Reply<TResponse>> done, int timeoutMilliseconds)
            where TResponse : IMessage, new()
        {
            int timeout = timeoutMilliseconds > 0 ? timeoutMilliseconds : _options.CallMilliseconds;
            return Requests.Send(
                "call_service",
                "call_service " + name,
                frame =>
                {
                    frame.Name("service").Value(name);
                    Names.WriteArguments(frame, request, "request", "type", "_Request");
                    frame.Name("nonfinite").Value("string");
                    frame.Name("timeout").Value(timeout / 1000.0);
                },
                reader =>
                {
                    TResponse response = new();
                    response.Read(reader);
                    return response;
                },
                done,
                timeout);
        }

        private string SendRequest<T>(
            string op, JsonValue members, Func<JsonReader, T> read, Action<Reply<T>> done, int timeoutMilliseconds) =>
            Requests.Send(
                op,
                op,
                frame => WriteMembers(frame, members),
                read,
                done,
                timeoutMilliseconds > 0 ? timeoutMilliseconds : _options.CallMilliseconds);

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

        private string NewId(string kind) => kind + Interlocked.Increment(ref _names);

        private void Tick()
        {
            if (_isDisposed == 1)
            {
                return;
            }
            long now = Clock.Now;
            _link.Tick(now);
            Requests.Tick(now);
            Publishers.Tick(now);
            Transforms.Tick(now);
            MissPump(now);
            if (Outbox.IsPingDue(now))
            {
                SendPing();
            }
            Outbox.Flush(); // for a transport that was busy and has no way to say that it no longer is
        }

        private void TellState()
        {
            Volatile.Write(ref _isStatePosted, 0);
            TellConnecting();
            _stateChanged.Call(State);
        }

        private void SendPing()
        {
            double now = Clock.Precise;
            Outbox.OnPing((long)now);
            Outbox.Send("ping", null, frame => frame.Name("value").Value(now));
        }

        void ILinkOwner.OnUp(ITransport transport)
        {
            Connections++;
            Outbox.Attach(transport);
            if (!string.IsNullOrEmpty(_options.Token))
            {
                Outbox.Send("auth", null, frame => frame.Name("token").Value(_options.Token));
            }
            Outbox.Send("hello");
            Publishers.Restore();
            Publishers.Driving?.Restore();
            Providers.Restore();
            Outbox.OpenQueues();
            Subscriptions.Restore();
            GraphWatch.Restore();
            Transforms.Restore();
        }

        void ILinkOwner.OnFrame(byte[] buffer, int count)
        {
            FramesReceived++;
            BytesReceived += count;
            try
            {
                _inbox.Read(buffer, count);
            }
            catch (Exception error)
            {
                // A fault of this client, not of the frame: told, and no reason to stop reading.
                Mailbox.Report(new GatewayEvent(
                    EventLevel.Error, "a frame could not be handled: " + error.Message, "internal", "", error));
            }
        }

        void ILinkOwner.OnSent(ITransport transport) => Outbox.OnSent(transport);

        void ILinkOwner.OnHeartbeat() => SendPing();

        void ILinkOwner.OnDown(string errorText)
        {
            Outbox.Detach();
            RosClock.Forget();
            _isGreeted = false;
            Providers.OnDown();
            Publishers.Driving?.OnDown();
            Transforms.OnDown();
            Requests.FailAll(errorText);
            Goals.FailAll(errorText);
        }

        void ILinkOwner.OnState(ConnectionState state)
        {
            if (Interlocked.Exchange(ref _isStatePosted, 1) == 0)
            {
                Mailbox.Post("StateChanged", TellState);
            }
        }

        void ILinkOwner.Report(EventLevel level, string text) => Reports.Tell(level, text, "client", "");

        void ILinkOwner.OnRefused(string text) => Reports.Failure("", text, Volatile.Read(ref _connects) > 0);

        /// <summary>A heartbeat is back: when it left (our clock, ms), and what ROS time was in the meantime (s).</summary>
        internal void OnPong(double sent, double rosSeconds)
        {
            Outbox.OnPong();
            _link.Praise();
            if (!double.IsNaN(sent))
            {
                Publishers.OnPong(sent);
                RosClock.Add(sent, rosSeconds);
            }
        }

        /// <summary>The gateway has introduced itself.</summary>
        internal void OnHello(JsonValue hello)
        {
            Outbox.MaxFrameBytes = (int)Math.Min(hello["limits"]["message_bytes"].AsLong(int.MaxValue), int.MaxValue);
            Greeted();
        }
    }
}
