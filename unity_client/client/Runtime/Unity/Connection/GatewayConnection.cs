// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using UnityEngine;
using UnityEngine.Events;

namespace Ros2Gateway.Unity
{
    /// <summary>The scene's connection: connects while it is enabled, and calls all handlers in Update.</summary>
    /// <remarks>
    /// Components that are given no connection find this one by themselves, whichever of them comes first, and take
    /// another when it is destroyed. Drivers, and components that were given this one, take only another to the same
    /// address. Disabling it disconnects, enabling it connects again. Topics that were subscribed or
    /// advertised stays until it is destroyed. While the application is paused (a headset that is put down, a
    /// desktop window without *Run In Background* that is left) it is disconnected.
    /// </remarks>
    [AddComponentMenu("ROS 2 Gateway/Gateway Connection")]
    [DefaultExecutionOrder(-1000)] // messages are there when other components' Update looks for them
    [DisallowMultipleComponent]
    public sealed class GatewayConnection : MonoBehaviour
    {
        private const int RememberedEvents = 200; // a log screen that comes late shows what led to the present

        [SerializeField]
        [Tooltip("ws://HOST:PORT. Empty: the address of the settings, or ws://localhost:9090 without settings")]
        private string _address = "";

        [SerializeField]
        [Tooltip("The settings that several scenes share: address, token, timeouts")]
        private GatewaySettings _settings;

        [SerializeField]
        [Tooltip("Stay when another scene is loaded, as an object without parent. Of several such connections to one "
            + "address, as when a scene is loaded again, the first stays")]
        private bool _dontDestroyOnLoad;

        [SerializeField]
        [Tooltip("Write events to Unity's console")]
        private bool _logToConsole = true;

        [SerializeField]
        private UnityEvent _onConnected = new();

        [SerializeField]
        private UnityEvent _onDisconnected = new();

        private readonly Queue<GatewayEvent> _events = new();
        private readonly Listeners<GatewayEvent> _eventHeard;
        private readonly Listeners<ConnectionState> _stateChanged;
        private readonly Listeners<string> _halted;
        private readonly Listeners<GatewayConnection> _leaving;
        private readonly Listeners<bool> _inspector; // the lists of the Inspector
        private GatewayClient _client;
        private string _token = ""; // from code, and so in no scene
        private string _givenToken = ""; // the client's token from here. It may have another by now
        private float _pumpMilliseconds = 4;
        private bool _wasConnected;
        private bool _isLeaving;
        private bool _isPaused;

        /// <summary>A component of the scene. Made by Unity.</summary>
        public GatewayConnection()
        {
            // Of the client's mailbox, which is made later, and again for each Play.
            _eventHeard = new Listeners<GatewayEvent>(ReportFault, "listener of EventHeard");
            _stateChanged = new Listeners<ConnectionState>(ReportFault, "listener of StateChanged");
            _halted = new Listeners<string>(ReportFault, "driver that is halted");
            _leaving = new Listeners<GatewayConnection>(ReportFault, "listener of Leaving");
            _inspector = new Listeners<bool>(ReportFault, "listener of On Connected or On Disconnected");
            _inspector.Add(isConnected => (isConnected ? _onConnected : _onDisconnected).Invoke());
        }

        /// <summary>Something that people should know, in the gateway's words or the client's.</summary>
        public event Action<GatewayEvent> EventHeard
        {
            add => _eventHeard.Add(value);
            remove => _eventHeard.Remove(value);
        }

        /// <summary>The connection was made or lost. Also while it is being made.</summary>
        public event Action<ConnectionState> StateChanged
        {
            add => _stateChanged.Add(value);
            remove => _stateChanged.Remove(value);
        }

        /// <summary>
        /// The connection is about to be ended from this side: the moment for last words, such as a robot's stop.
        /// </summary>
        public event Action<GatewayConnection> Leaving
        {
            add => _leaving.Add(value);
            remove => _leaving.Remove(value);
        }

        /// <summary>Someone stops the robot: whatever drives it by this connection gives up.</summary>
        internal event Action<string> Halted
        {
            add => _halted.Add(value);
            remove => _halted.Remove(value);
        }

        /// <summary>The client. It is there from the first use on, connected or not.</summary>
        public GatewayClient Client => _client ??= NewClient();

        /// <summary>The newest events, the oldest first.</summary>
        public IEnumerable<GatewayEvent> Events => _events;

        /// <summary>Called when the connection was made, from the Inspector's list.</summary>
        public UnityEvent OnConnected => _onConnected;

        /// <summary>Called when the connection was lost, from the Inspector's list.</summary>
        public UnityEvent OnDisconnected => _onDisconnected;

        /// <summary>
        /// The address of the gateway. Another one, for instance from a text field, counts when the component is
        /// enabled the next time. An empty one is that of the settings.
        /// </summary>
        public string Address
        {
            get => Options().Address;
            set => _address = value ?? "";
        }

        /// <summary>
        /// The token for the gateway, set from code, so that it is in no asset and no build. It goes before that
        /// of the settings unless it is empty. Like <see cref="Address"/>.
        /// </summary>
        public string Token
        {
            set => _token = value ?? "";
        }

        /// <summary>The settings that several scenes share. Like <see cref="Address"/>.</summary>
        public GatewaySettings Settings
        {
            get => _settings;
            set => _settings = value;
        }

        /// <summary>Whether it stays when another scene is loaded. Before it is active.</summary>
        public bool OutlivesScenes
        {
            get => _dontDestroyOnLoad;
            set => _dontDestroyOnLoad = value;
        }

        /// <summary>
        /// Whether it is being destroyed, be it as another, which outlives its scene, has taken its place.
        /// </summary>
        internal bool IsOver { get; private set; }

        /// <summary>
        /// The address that it leads to now, or led to before it was destroyed: not one that counts only later.
        /// </summary>
        internal string Gateway => _client != null ? _client.Address : Address;

        /// <summary>The options for a client of this connection.</summary>
        public GatewayOptions Options()
        {
            GatewayOptions options = _settings != null ? _settings.Options() : new GatewayOptions();
            options.Address = _address.Length > 0 ? _address : options.Address;
            options.Token = _token.Length > 0 ? _token : options.Token ?? "";
            return options;
        }

        /// <summary>Makes everything that drives a robot by this connection give up, with the reason.</summary>
        internal void Halt(string reason) => _halted.Call(reason);

        private void Awake()
        {
            IsOver = _dontDestroyOnLoad && LiveConnections.Lasting(this) != null;
            if (IsOver)
            {
                Destroy(this);
                return;
            }
            LiveConnections.Add(this);
        }

        private void OnEnable()
        {
            if (IsOver)
            {
                return;
            }
            if (_client != null && _client.IsDisposed)
            {
                _client = null; // of the last Play, where the editor reloads neither scripts nor scene
            }
            _isPaused = false;
            GatewayOptions options = Options();
            Client.Address = options.Address;
            if (options.Token != _givenToken) // else one that code gave to the client stays
            {
                Client.Token = _givenToken = options.Token;
            }
            Client.Connect();
            LiveConnections.Add(this);
            LiveConnections.Tell();
        }

        private void Start()
        {
            if (_dontDestroyOnLoad && !IsOver)
            {
                transform.SetParent(null); // Unity keeps no other. Not in Awake, when a parent may be being activated
                DontDestroyOnLoad(gameObject);
            }
        }

        private void Update() => Client.Pump(_pumpMilliseconds);

        private void OnApplicationPause(bool isPaused)
        {
            if (isPaused == _isPaused || _client == null || !isActiveAndEnabled)
            {
                return; // Android says at the start that it is not paused
            }
            _isPaused = isPaused;
            if (isPaused)
            {
                Leave(true); // the socket of an application that sleeps is dead when it wakes, and nobody would notice
            }
            else
            {
                _client.Connect();
            }
        }

        private void OnDisable()
        {
            Leave(false);
            LiveConnections.Tell();
        }

        private void OnDestroy()
        {
            IsOver = true;
            LiveConnections.Remove(this);
            _client?.Dispose(); // and stays, for those who look at it in their own OnDestroy
        }

        private void Leave(bool isForAWhile)
        {
            if (_client == null || _isLeaving)
            {
                return;
            }
            _isLeaving = true; // a listener may destroy this
            try
            {
                _leaving.Call(this);
                if (isForAWhile)
                {
                    _client.Suspend();
                }
                else
                {
                    _client.Disconnect();
                }
                _client.Pump(0); // so that all hear of it
            }
            finally
            {
                _isLeaving = false;
            }
        }

        private void ReportFault(string where, Exception error, long times) => Client.ReportFault(where, error, times);

        private GatewayClient NewClient()
        {
            GatewayOptions options = Options();
            _givenToken = options.Token;
            _pumpMilliseconds = _settings != null ? _settings.PumpMilliseconds : _pumpMilliseconds;
#if UNITY_WEBGL && !UNITY_EDITOR
            options.Transport = chosen => new WebGlTransport(chosen.MaxMessageBytes);
            options.UsesThreads = false;
#endif
            GatewayClient client = new(options);
            client.EventHeard += Hear;
            client.StateChanged += Changed;
            return client;
        }

        private void Hear(GatewayEvent happened)
        {
            if (_events.Count >= RememberedEvents)
            {
                _events.Dequeue();
            }
            _events.Enqueue(happened);
            if (_logToConsole)
            {
                Log(happened);
            }
            _eventHeard.Call(happened);
        }

        private void Log(GatewayEvent happened)
        {
            Action<object, UnityEngine.Object> log = happened.Level switch
            {
                EventLevel.Error => Debug.LogError,
                EventLevel.Warning => Debug.LogWarning,
                _ => Debug.Log,
            };
            log("[ROS 2 Gateway] " + happened, this); // which handler it was. The stack is the exception's
            if (happened.Exception != null)
            {
                Debug.LogException(happened.Exception, this);
            }
        }

        private void Changed(ConnectionState state)
        {
            bool isConnected = state == ConnectionState.Connected;
            if (isConnected != _wasConnected)
            {
                _wasConnected = isConnected;
                _inspector.Call(isConnected);
            }
            _stateChanged.Call(state);
        }
    }
}
