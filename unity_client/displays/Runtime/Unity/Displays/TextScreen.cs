// SPDX-License-Identifier: Apache-2.0
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>Shows the messages of any topic as text, a field a line.</summary>
    [AddComponentMenu("ROS 2 Gateway/Text Screen")]
    public sealed class TextScreen : TopicDisplay<IMessage>
    {
        private const float Interval = 0.1f; // seconds: nobody reads faster
        private const float Share = 0.02f; // of the main thread, for messages that are long to write

        [SerializeField]
        [Tooltip("Longer messages are cut")]
        [Range(1, 200)]
        private int _maxLines = 30;

        [SerializeField]
        private TextOutput _text = new();

        private MessageText _writer;
        private IMessage _waiting;
        private float _next;

        /// <summary>The text, and its places.</summary>
        public TextOutput Output => _text;

        /// <summary>Longer messages are cut. Takes effect when it is enabled the next time.</summary>
        public int MaxLines
        {
            get => _maxLines;
            set => _maxLines = value;
        }

        /// <inheritdoc/>
        protected override void OnEnable()
        {
            base.OnEnable();
            _writer = new MessageText(_maxLines);
            _text.Demand(this, false); // tags in a message are the message's text
        }

        /// <inheritdoc/>
        protected override void Update()
        {
            base.Update();
            if (_waiting == null || Time.unscaledTime < _next)
            {
                return;
            }
            float began = Time.realtimeSinceStartup;
            _text.Show(_writer.Of(_waiting));
            _waiting = null;
            float cost = Time.realtimeSinceStartup - began;
            _next = Time.unscaledTime + Mathf.Max(Interval, cost / Share);
        }

        /// <inheritdoc/>
        protected override bool Draw(IMessage message)
        {
            _waiting = message;
            return true;
        }
    }
}
