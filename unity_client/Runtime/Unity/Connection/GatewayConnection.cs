// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using UnityEngine;
using UnityEngine.Events;

namespace Ros2Gateway.Unity
{
    /// <summary>The scene's connection: connects while it is enabled, and calls all handlers in Update.</summary>
    /// <remarks>
    /// Components that are given no connection take the one that they find in the scene. Disabling it
    /// disconnects, enabling it connects again; what was subscribed and advertised stays until it is destroyed.
    /// </remarks>
    [AddComponentMenu("ROS 2 Gateway/Gateway Connection")]
    [DefaultExecutionOrder(-1000)] // messages are there when other components' Update looks for them
    [DisallowMultipleComponent]
    public sealed class GatewayConnection : MonoBehaviour
    {
        private const int RememberedEvents = 200; // a log screen that comes late shows what led to the present

        [SerializeField]
        [Tooltip("Where the gateway is; without, ws://localhost:9090")]
        private GatewaySettings _settings;

        [SerializeField]
        [Tooltip("Write events to Unity's console")]
        private bool _logToConsole = true;

        [SerializeField]
        private UnityEvent _onConnected = new UnityEvent();

        [SerializeField]
        private UnityEvent _onDisconnected = new UnityEvent();

        private readonly Queue<GatewayEvent> _events = new Queue<GatewayEvent>();
        private GatewayClient _client;
        private float _pumpMilliseconds = 4;
        private bool _wasConnected;
        private bool _isLeaving;

        /// <summary>Something that people should know, in the gateway's words or the client's.</summary>
        public event Action<GatewayEvent> EventHeard;

        /// <summary>The connection was made or lost; also while it is being made.</summary>
        public event Action<ConnectionState> StateChanged;

        /// <summary>Somebody stops the robot: whatever drives it by this connection gives up.</summary>
        internal event Action<string> Halted;

        /// <summary>
        /// The connection is about to be ended from this side: the moment for last words, such as a robot's stop.
        /// </summary>
        public event Action Leaving;

        /// <summary>The client; it is there from the first use on, connected or not.</summary>
        public GatewayClient Client
        {
            get
            {
                if (_client == null)
                {
                    _client = NewClient();
                }
                return _client;
            }
        }

        /// <summary>The newest events, the oldest first.</summary>
        public IEnumerable<GatewayEvent> Events
        {
            get { return _events; }
        }

        /// <summary>Called when the connection was made, from the Inspector's list.</summary>
        public UnityEvent OnConnected
        {
            get { return _onConnected; }
        }

        /// <summary>Called when the connection was lost, from the Inspector's list.</summary>
        public UnityEvent OnDisconnected
        {
            get { return _onDisconnected; }
        }

        /// <summary>
        /// Where the gateway is. Another address, for instance from a text field, counts when the component is
        /// enabled the next time.
        /// </summary>
        public GatewaySettings Settings
        {
            get { return _settings; }
            set { _settings = value; }
        }

        /// <summary>The connection that a component uses: its own choice, else the scene's, else null and a warning.</summary>
        public static GatewayConnection For(Component component, GatewayConnection chosen)
        {
            if (chosen != null)
            {
                return chosen;
            }
            GatewayConnection found = FindAnyObjectByType<GatewayConnection>();
            if (found == null)
            {
                Debug.LogWarning(
                    component.GetType().Name + " on " + component.name
                    + " finds no Gateway Connection: add one to the scene", component);
            }
            return found;
        }

        /// <summary>Makes everything that drives a robot by this connection give up, with the reason.</summary>
        internal void Halt(string reason)
        {
            if (Halted != null)
            {
                Halted(reason);
            }
        }

        private void OnEnable()
        {
            if (_client != null && _client.IsDisposed)
            {
                _client = null; // of the last Play, where the editor reloads neither scripts nor scene
            }
            if (_settings != null)
            {
                Client.Address = _settings.Address;
                Client.Token = _settings.Token;
            }
            Client.Connect();
        }

        private void Update()
        {
            Client.Pump(_pumpMilliseconds);
        }

        private void OnDisable()
        {
            if (_client == null || _isLeaving)
            {
                return;
            }
            _isLeaving = true; // whoever hears of it may destroy this
            try
            {
                if (Leaving != null)
                {
                    Leaving();
                }
                _client.Disconnect();
                _client.Pump(0); // so that all hear of it
            }
            finally
            {
                _isLeaving = false;
            }
        }

        private void OnDestroy()
        {
            if (_client != null)
            {
                _client.Dispose(); // and stays, for those who look at it in their own OnDestroy
            }
        }

        private GatewayClient NewClient()
        {
            GatewayOptions options = _settings != null ? _settings.Options() : new GatewayOptions();
            _pumpMilliseconds = _settings != null ? _settings.PumpMilliseconds : _pumpMilliseconds;
#if UNITY_WEBGL && !UNITY_EDITOR
            options.Transport = chosen => new WebGlTransport(chosen.MaxMessageBytes);
            options.UsesThreads = false;
#endif
            GatewayClient client = new GatewayClient(options);
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
            if (EventHeard != null)
            {
                EventHeard(happened);
            }
        }

        private void Log(GatewayEvent happened)
        {
            string text = "[ROS 2 Gateway] " + happened;
            if (happened.Exception != null)
            {
                Debug.LogException(happened.Exception, this);
            }
            else if (happened.Level == EventLevel.Error)
            {
                Debug.LogError(text, this);
            }
            else if (happened.Level == EventLevel.Warning)
            {
                Debug.LogWarning(text, this);
            }
            else
            {
                Debug.Log(text, this);
            }
        }

        private void Changed(ConnectionState state)
        {
            bool isConnected = state == ConnectionState.Connected;
            if (isConnected != _wasConnected)
            {
                _wasConnected = isConnected;
                (isConnected ? _onConnected : _onDisconnected).Invoke();
            }
            if (StateChanged != null)
            {
                StateChanged(state);
            }
        }
    }
}
