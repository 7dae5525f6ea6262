// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// Shows the messages of the Topic Subscriber beside it; the base of all displays of one type.
    /// </summary>
    [RequireComponent(typeof(TopicSubscriber))]
    public abstract class TopicDisplay<T> : MonoBehaviour
        where T : class, IMessage
    {
        private const int MaxComplaints = 8; // what is wrong with so many messages is wrong with all

        private readonly List<string> _complaints = new List<string>();
        private T _newest;
        private float _newestTime;
        private float _drawnTime = float.NegativeInfinity;

        /// <summary>Whose messages are shown.</summary>
        public TopicSubscriber Subscriber { get; private set; }

        /// <summary>
        /// How long ago the message came that is shown, in seconds; infinite before the first. What could not
        /// be shown does not count.
        /// </summary>
        public float AgeSeconds
        {
            get { return Time.unscaledTime - _drawnTime; }
        }

        /// <summary>
        /// Shows a message in Update unless a newer one comes until then. The subscriber's messages come here
        /// by themselves; others may, too, such as those of a recording.
        /// </summary>
        public void Show(T message)
        {
            _newest = message;
            _newestTime = Time.unscaledTime;
        }

        /// <summary>Draws a message; in Update, of several that came in a frame only the newest.</summary>
        /// <returns>Whether it could be drawn.</returns>
        protected abstract bool Draw(T message);

        /// <summary>Begins to listen; overriders call it.</summary>
        protected virtual void OnEnable()
        {
            Subscriber = GetComponent<TopicSubscriber>();
            Subscriber.MessageReceived += Receive;
        }

        /// <summary>Draws what has come; overriders call it.</summary>
        protected virtual void Update()
        {
            T message = _newest;
            if (message != null)
            {
                _newest = null;
                _drawnTime = Draw(message) ? _newestTime : _drawnTime;
            }
        }

        /// <summary>Listens no longer; overriders call it.</summary>
        protected virtual void OnDisable()
        {
            Subscriber.MessageReceived -= Receive;
            _newest = null;
        }

        /// <summary>Logs what is wrong with a message, the same words only once.</summary>
        protected void Complain(string words)
        {
            if (_complaints.Count < MaxComplaints && !_complaints.Contains(words))
            {
                _complaints.Add(words);
                Debug.LogWarning(GetType().Name + " on " + name + ": " + words, this);
            }
        }

        private void Receive(IMessage message)
        {
            T shown = message as T;
            if (shown != null)
            {
                Show(shown);
                return;
            }
            Complain(
                "shows " + typeof(T).Name + ", but " + Subscriber.Topic + " carries "
                + (message.RosType.Length > 0 ? message.RosType : "a message without a class")
                + ": set the subscriber's type");
        }
    }
}
