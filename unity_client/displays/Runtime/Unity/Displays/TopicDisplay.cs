// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;
using Ros2Gateway.Pictures;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// Shows the messages of the Topic Subscriber next to it. The base of all displays of one type.
    /// </summary>
    [RequireComponent(typeof(TopicSubscriber))]
    public abstract class TopicDisplay<T> : MonoBehaviour, INewestOnly
        where T : class, IMessage
    {
        private const int MaxWarnings = 8; // a fault in this many messages is a fault in all

        private readonly List<string> _warnings = new();

        [System.NonSerialized] // else the editor makes an empty message of none when it reloads scripts
        private T _newest;
        private float _newestTime;
        private IMessage _earlier; // came before this was enabled, and waits for Update
        private float _earlierTime;
        private float _drawnTime = float.NegativeInfinity;

        /// <summary>Whose messages are shown.</summary>
        public TopicSubscriber Subscriber { get; private set; }

        /// <summary>
        /// How long ago the message came that is shown, in seconds. Infinite before the first. A message that could not
        /// be shown does not count.
        /// </summary>
        public float AgeSeconds => Time.unscaledTime - _drawnTime;

        bool INewestOnly.IsNewestOnly => !DrawsEvery;

        /// <summary>
        /// Whether a message changes only a part of what is shown. Then each is drawn when it comes, in order, and a
        /// subscriber whose Queue is 0 asks for them all. Else the newest is drawn in Update.
        /// </summary>
        protected virtual bool DrawsEvery => false;

        /// <summary>
        /// Shows a message in Update unless a newer one comes until then. At once if <see cref="DrawsEvery"/>, and then
        /// only while this is enabled. The subscriber's messages come here by themselves. Others may as well, such as those
        /// of a recording.
        /// </summary>
        public virtual void Show(T message)
        {
            ReceiveEarlier(null); // first
            if (DrawsEvery)
            {
                // not kept until Update: where messages are filled again, the next one may be on its way into this
                if (isActiveAndEnabled && Draw(message))
                {
                    SetDrawn(0);
                }
                return;
            }
            _newest = message;
            _newestTime = Time.unscaledTime;
        }

        /// <summary>
        /// Draws a message. In Update, of several that came in a frame only the newest, unless
        /// <see cref="DrawsEvery"/>.
        /// </summary>
        /// <returns>Whether it could be drawn.</returns>
        protected abstract bool Draw(T message);

        /// <summary>
        /// The message that comes as another class, if this display knows that. Else null. A display of pictures gets a
        /// copy of one that is filled again.
        /// </summary>
        protected virtual T Converted(IMessage message)
        {
            PictureMsg picture = message as PictureMsg;
            return picture == null ? message as T : picture.Copy() as T;
        }

        /// <summary>Gets what the subscriber receives: shows it, unless it is overridden.</summary>
        protected virtual void Receive(T message) => Show(message);

        /// <summary>Notes that a message is shown now which came so long ago. For what Draw only begins.</summary>
        protected void SetDrawn(float ageSeconds) => _drawnTime = Time.unscaledTime - ageSeconds;

        /// <summary>
        /// Begins to listen. Overriders call it. A message that the subscriber has already, such as a map, which is sent
        /// once, comes in Update. An Image Screen waits for the next picture.
        /// </summary>
        protected virtual void OnEnable()
        {
            Subscriber = GetComponent<TopicSubscriber>();
            Subscriber.MessageReceived += ReceiveAny;
            _earlier = _newest == null ? Subscriber.Kept : null; // else something was shown by hand
            _earlierTime = Subscriber.LastTime;
        }

        /// <summary>Draws what has come. Overriders call it.</summary>
        protected virtual void Update()
        {
            ReceiveEarlier(null);
            T message = _newest;
            if (message != null)
            {
                _newest = null;
                _drawnTime = Draw(message) ? _newestTime : _drawnTime;
            }
        }

        /// <summary>Listens no longer. Overriders call it.</summary>
        protected virtual void OnDisable()
        {
            Subscriber.MessageReceived -= ReceiveAny;
            _newest = null;
            _earlier = null;
        }

        /// <summary>Logs what is wrong with a message, the same only once.</summary>
        protected void Warn(string warning)
        {
            if (_warnings.Count < MaxWarnings && !_warnings.Contains(warning))
            {
                _warnings.Add(warning);
                Debug.LogWarning(GetType().Name + " on " + name + ": " + warning, this);
            }
        }

        /// <summary>Tells that a listener of this component has thrown, which is to harm no other.</summary>
        internal void ReportFault(string where, System.Exception error, long times) =>
            FaultLog.Write(this, where, error, times);

        private void ReceiveAny(IMessage message)
        {
            ReceiveEarlier(message);
            T shown = Converted(message);
            if (shown != null)
            {
                Receive(shown);
                return;
            }
            Warn(
                "shows " + typeof(T).Name + ", but " + Subscriber.Topic + " carries "
                + (message.RosType.Length > 0 ? message.RosType : "a message without a class")
                + ": set the subscriber's type");
        }

        /// <summary>Receives what came before this was enabled, as old as it is.</summary>
        /// <param name="next">The message that arrives now, which may be the same, or null.</param>
        private void ReceiveEarlier(IMessage next)
        {
            IMessage earlier = _earlier;
            _earlier = null;
            T shown = earlier == null || earlier == next ? null : Converted(earlier);
            if (shown != null)
            {
                Receive(shown);
                _newestTime = _earlierTime;
                _drawnTime = Mathf.Min(_drawnTime, _earlierTime); // if it was drawn at once
            }
        }
    }
}
