// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Messages.GeometryMsgs;

namespace Ros2Gateway.Drive
{
    /// <summary>
    /// Which velocities a robot takes, Twist or TwistStamped, by the types that its topic has in the graph.
    /// </summary>
    /// <remarks>
    /// The graph does not say whose a type is, and a publisher of ours adds its own. So where both are there, ours is
    /// withdrawn for a while to see which stays. Until then, nothing moves.
    /// Time comes as an argument, in milliseconds.
    /// </remarks>
    internal sealed class CommandType
    {
        // The gateway keeps a publisher that was withdrawn for 0.5 s, and its guard's follows a moment later.
        private const long LookMilliseconds = 3000;

        private readonly string _topic;
        private string _former; // the type that was sent before it was withdrawn
        private string _settledFor; // the subscribers among whom both types stayed
        private string _subscribers = "";
        private bool _areBoth;
        private long _lookUntil;

        internal CommandType(string topic)
        {
            _topic = topic;
            Reason = "asking which type " + topic + " has";
        }

        /// <summary>The type to publish, pkg/msg/Name. Null while none is known.</summary>
        internal string Name { get; private set; }

        /// <summary>Why it is missing, in words. Null if there is one.</summary>
        internal string Reason { get; private set; }

        /// <summary>The graph has come, or has changed.</summary>
        internal void See(RosGraph graph, long now)
        {
            string[] types = graph.TopicTypes(_topic);
            bool isPlain = Array.IndexOf(types, TwistMsg.Type) >= 0;
            bool isStamped = Array.IndexOf(types, TwistStampedMsg.Type) >= 0;
            bool wereBoth = _areBoth;
            _areBoth = isPlain && isStamped;
            _subscribers = string.Join(" ", graph.TopicSubscribers(_topic));
            if (!_areBoth)
            {
                _settledFor = null;
                _former = null;
                string none = types.Length == 0
                    ? "no robot listens to commands on " + _topic + " yet"
                    : _topic + " has type " + string.Join(" and ", types) + ", not Twist or TwistStamped";
                Take(isPlain ? TwistMsg.Type : isStamped ? TwistStampedMsg.Type : null, none);
            }
            else if ((!wereBoth || Name != null) && _subscribers != _settledFor)
            {
                _former = Name ?? _former;
                _lookUntil = now + LookMilliseconds;
                Take(null, _topic + " has types Twist and TwistStamped: waiting until one is left");
            }
        }

        /// <summary>Ends the look, if it is time to.</summary>
        internal void Tick(long now)
        {
            if (_areBoth && Name == null && now >= _lookUntil)
            {
                _settledFor = _subscribers;
                Take(_former ?? TwistMsg.Type, null);
            }
        }

        private void Take(string name, string reason)
        {
            Name = name;
            Reason = name == null ? reason : null;
        }
    }
}
