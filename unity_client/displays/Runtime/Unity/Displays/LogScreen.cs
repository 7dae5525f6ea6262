// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Text;
using Ros2Gateway.Messages.RclInterfaces;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>Levels of ROS' log. The numbers are those of rcl_interfaces/msg/Log.</summary>
    public enum LogLevel
    {
        /// <summary>For who looks for a fault.</summary>
        Debug = LogMsg.DEBUG,

        /// <summary>Something was done.</summary>
        Info = LogMsg.INFO,

        /// <summary>Something may not be as it was meant.</summary>
        Warning = LogMsg.WARN,

        /// <summary>Something failed.</summary>
        Error = LogMsg.ERROR,

        /// <summary>A node cannot go on.</summary>
        Fatal = LogMsg.FATAL,
    }

    /// <summary>
    /// Shows the log of all nodes (/rosout) and the client's own events, the newest at the bottom.
    /// </summary>
    [AddComponentMenu("ROS 2 Gateway/Log Screen")]
    public sealed class LogScreen : ConnectedBehaviour
    {
        private const float Interval = 0.1f; // seconds: nobody reads faster
        private const int Queue = 200; // messages: a node that starts says so much at once
        private const int LongestLine = 200; // characters: two lines of a screen

        [SerializeField]
        private string _topic = "/rosout";

        [SerializeField]
        [Tooltip("Less severe lines are left out")]
        private LogLevel _minLevel = LogLevel.Info;

        [SerializeField]
        [Range(1, 200)]
        private int _maxLines = 20;

        [SerializeField]
        [Tooltip("Also show the events of the client and the gateway")]
        private bool _withEvents = true;

        [SerializeField]
        private TextOutput _text = new();

        private readonly Queue<string> _lines = new();
        private readonly StringBuilder _builder = new();
        private Subscription<LogMsg> _subscription;
        private DateTime _lastEvent;
        private bool _isChanged;
        private float _next;

        /// <summary>Less severe lines are left out, from now on.</summary>
        public LogLevel MinLevel
        {
            get => _minLevel;
            set => _minLevel = value;
        }

        /// <summary>How many lines are kept.</summary>
        public int MaxLines
        {
            get => _maxLines;
            set => _maxLines = value;
        }

        /// <summary>The text, and its places.</summary>
        public TextOutput Output => _text;

        /// <summary>Adds a line, such as the application's own.</summary>
        public void Add(LogLevel level, string source, string words)
        {
            if (level < _minLevel)
            {
                return;
            }
            string line = level.ToString().ToUpperInvariant() + " " + source + ": " + words;
            if (line.Length > LongestLine)
            {
                line = line.Substring(0, LongestLine) + "...";
            }
            _lines.Enqueue("<color=" + ColorOf(level) + ">" + Plain(line) + "</color>");
            while (_lines.Count > Math.Max(1, _maxLines))
            {
                _lines.Dequeue();
            }
            _isChanged = true;
        }

        /// <summary>Forgets all lines.</summary>
        public void Clear()
        {
            _lines.Clear();
            _isChanged = true;
        }

        /// <inheritdoc/>
        protected override void OnEnable()
        {
            _text.Demand(this, true);
            base.OnEnable();
        }

        private void Update()
        {
            if (_isChanged && Time.unscaledTime >= _next)
            {
                _isChanged = false;
                _next = Time.unscaledTime + Interval;
                Write();
            }
        }

        /// <inheritdoc/>
        protected override void Bind(GatewayConnection connection)
        {
            foreach (GatewayEvent happened in connection.Events)
            {
                if (happened.Time > _lastEvent)
                {
                    Hear(happened);
                }
            }
            connection.EventHeard += Hear;
            _subscription = connection.Client.Subscribe<LogMsg>(
                _topic, Receive, new SubscribeOptions { Queue = Queue });
        }

        /// <inheritdoc/>
        protected override void Unbind(GatewayConnection connection)
        {
            connection.EventHeard -= Hear;
            _subscription.Dispose();
            _subscription = null;
        }

        private void Receive(LogMsg message) => Add((LogLevel)message.level, message.name, message.msg);

        private void Hear(GatewayEvent happened)
        {
            _lastEvent = happened.Time;
            if (!_withEvents)
            {
                return;
            }
            LogLevel level = happened.Level == EventLevel.Error ? LogLevel.Error
                : happened.Level == EventLevel.Warning ? LogLevel.Warning : LogLevel.Info;
            string source = happened.Request.Length > 0 ? "gateway: " + happened.Request : "gateway";
            Add(level, source, happened.Text);
        }

        private void Write()
        {
            _builder.Clear();
            foreach (string line in _lines)
            {
                if (_builder.Length > 0)
                {
                    _builder.Append('\n');
                }
                _builder.Append(line);
            }
            _text.Show(_builder.ToString());
        }

        /// <summary>One line without tags: a log message is text, whatever it says.</summary>
        private static string Plain(string words) => words.Replace("\r", "").Replace('\n', ' ').Replace("<", "< ");

        private static string ColorOf(LogLevel level) =>
            level >= LogLevel.Fatal ? "#ff60ff"
                : level >= LogLevel.Error ? "#ff6060"
                : level >= LogLevel.Warning ? "#ffd040"
                : level >= LogLevel.Info ? "#ffffff" : "#a0a0a0";
    }
}
