// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Linq;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>The ROS graph: topics, services and actions with their types, and nodes. Never changes.</summary>
    public sealed class RosGraph
    {
        private static readonly string[] Nothing = new string[0];

        private readonly SortedDictionary<string, string[]> _topics;
        private readonly SortedDictionary<string, string[]> _subscribers;
        private readonly SortedDictionary<string, string[]> _services;
        private readonly SortedDictionary<string, string[]> _actions;
        private readonly SortedDictionary<string, string[]> _nodes;

        internal RosGraph()
            : this(null, null)
        {
        }

        private RosGraph(RosGraph before, JsonValue changes)
        {
            _topics = Merged(before?._topics, changes, "topics", "types");
            _subscribers = Merged(before?._subscribers, changes, "topics", "subscribers");
            _services = Merged(before?._services, changes, "services", "types");
            _actions = Merged(before?._actions, changes, "actions", "types");
            _nodes = Merged(before?._nodes, changes, "nodes", "");
        }

        /// <summary>Topics in the order of their names.</summary>
        public IEnumerable<string> Topics => _topics.Keys;

        /// <summary>Services in the order of their names.</summary>
        public IEnumerable<string> Services => _services.Keys;

        /// <summary>Actions in the order of their names.</summary>
        public IEnumerable<string> Actions => _actions.Keys;

        /// <summary>Nodes in the order of their names.</summary>
        public IEnumerable<string> Nodes => _nodes.Keys;

        /// <summary>The type of a topic. Empty if there is no such topic, or if it has several types.</summary>
        public string TopicType(string topic) => Only(_topics, topic);

        /// <summary>The types of a topic, in order. None if there is no such topic, mostly one.</summary>
        public string[] TopicTypes(string topic) => All(_topics, topic);

        /// <summary>The nodes that subscribe to a topic, one for each subscription.</summary>
        public string[] TopicSubscribers(string topic) => All(_subscribers, topic);

        /// <summary>The type of a service. Empty if there is no such service.</summary>
        public string ServiceType(string service) => Only(_services, service);

        /// <summary>The type of an action. Empty if there is no such action.</summary>
        public string ActionType(string action) => Only(_actions, action);

        internal static RosGraph Read(JsonValue frame) => new RosGraph(null, frame);

        internal RosGraph With(JsonValue changes) => new RosGraph(this, changes);

        private static string Only(SortedDictionary<string, string[]> of, string name) =>
            of.TryGetValue(Names.Absolute(name), out string[] types) && types.Length == 1 ? types[0] : "";

        private static string[] All(SortedDictionary<string, string[]> of, string name) =>
            of.TryGetValue(Names.Absolute(name), out string[] all) ? (string[])all.Clone() : Nothing;

        // Takes over the entries of one kind that are new or different, what a member of them says.
        private static SortedDictionary<string, string[]> Merged(
            SortedDictionary<string, string[]> before, JsonValue changes, string kind, string member)
        {
            SortedDictionary<string, string[]> after = before == null
                ? new SortedDictionary<string, string[]>(StringComparer.Ordinal)
                : new SortedDictionary<string, string[]>(before, StringComparer.Ordinal);
            if (changes == null)
            {
                return after;
            }
            foreach (JsonValue one in changes[kind].Items)
            {
                if (one.Kind == JsonKind.String)
                {
                    after[one.AsString("")] = Nothing; // a node is its name
                    continue;
                }
                after[one["name"].AsString("")] = one[member].Items.Select(word => word.AsString("")).ToArray();
            }
            foreach (JsonValue one in changes["gone_" + kind].Items)
            {
                after.Remove(one.AsString(""));
            }
            return after;
        }
    }
}
