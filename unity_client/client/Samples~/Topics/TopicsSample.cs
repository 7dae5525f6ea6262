// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Messages.StdMsgs;
using Ros2Gateway.Unity;
using UnityEngine;

namespace Ros2Gateway.Samples.Topics
{
    /// <summary>Publishes a text every second, and logs what comes back.</summary>
    public sealed class TopicsSample : ConnectedBehaviour
    {
        [SerializeField]
        private string _topic = "/unity/hello";

        private Publisher<StringMsg> _publisher;
        private Subscription<StringMsg> _subscription;
        private float _next;
        private int _count;

        /// <summary>The last text that came back. Null before the first.</summary>
        public string Heard { get; private set; }

        /// <inheritdoc/>
        protected override void Bind(GatewayConnection connection)
        {
            _publisher = connection.Client.Advertise<StringMsg>(_topic);
            _subscription = connection.Client.Subscribe<StringMsg>(_topic, Hear);
        }

        /// <inheritdoc/>
        protected override void Unbind(GatewayConnection connection)
        {
            _publisher.Dispose();
            _publisher = null;
            _subscription.Dispose();
        }

        private void Update()
        {
            if (_publisher != null && Connection.Client.IsConnected && Time.unscaledTime >= _next)
            {
                _next = Time.unscaledTime + 1;
                _publisher.Publish(new StringMsg { data = "hello " + ++_count });
            }
        }

        private void Hear(StringMsg message)
        {
            Heard = message.data;
            Debug.Log("heard: " + message.data, this);
        }
    }
}
