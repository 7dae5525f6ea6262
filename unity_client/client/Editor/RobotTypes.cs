// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Linq;
using Ros2Gateway.Json;

namespace Ros2Gateway.Editor
{
    /// <summary>
    /// The types that a robot has, and C# of them: both as its gateway tells. Pump it from the editor's update.
    /// </summary>
    public sealed class RobotTypes : IDisposable
    {
        private const int MaxUses = 3; // as many as a line of a window holds

        private readonly EditorClient _client;
        private readonly List<string> _installed = new();
        private RosGraph _graph;
        private RobotType[] _types = new RobotType[0];
        private string _refusal = "";
        private bool _isAsked;

        /// <summary>Begins to connect, to where these options say.</summary>
        public RobotTypes(GatewayOptions options)
        {
            _client = new EditorClient(options);
            _client.Client.WatchGraph(Take);
            Problem = Words();
        }

        /// <summary>The content has changed.</summary>
        public event Action Changed;

        /// <summary>
        /// Those that a topic, a service or an action has, then the others, each by name. The last known ones
        /// while the connection is lost. Like <see cref="Problem"/> it changes in <see cref="Pump"/> only: the
        /// editor draws in two passes, which must agree.
        /// </summary>
        public IReadOnlyList<RobotType> Types => _types;

        /// <summary>Why types are missing or old, in words. Empty if they are as they are now.</summary>
        public string Problem { get; private set; }

        /// <summary>Calls what waits. From the editor's update.</summary>
        public void Pump()
        {
            _client.Pump();
            if (_client.Client.IsConnected && !_isAsked)
            {
                _isAsked = true;
                _client.Client.CallService<Interfaces>(
                    "/rosapi/interfaces", new DynamicMessage("rosapi_msgs/srv/Interfaces_Request"), TakeInstalled);
            }
            _isAsked = _isAsked && _client.Client.IsConnected; // of another robot, perhaps, the next time
            string problem = Words();
            if (problem != Problem)
            {
                Problem = problem;
                Tell();
            }
        }

        /// <summary>Has the gateway write the classes of types, as an assembly of that name.</summary>
        public void Generate(IEnumerable<string> types, string assembly, Action<Reply<JsonValue>> done)
        {
            JsonValue names = JsonValue.Array(types.Select(type => (JsonValue)type).ToArray());
            JsonValue members = JsonValue.Object()
                .With("language", "csharp").With("types", names).With("asmdef", assembly);
            _client.Client.Request("generate", members, done);
        }

        /// <summary>Disconnects.</summary>
        public void Dispose() => _client.Dispose();

        private void Take(RosGraph graph)
        {
            _graph = graph;
            Merge();
        }

        private void TakeInstalled(Reply<Interfaces> reply)
        {
            _refusal = reply.Ok ? "" : "only types in use are listed: " + reply.Error;
            _installed.Clear();
            if (reply.Ok)
            {
                _installed.AddRange(reply.Value.Names);
            }
            Merge();
        }

        private void Merge()
        {
            SortedDictionary<string, List<string>> uses =
                new(StringComparer.Ordinal);
            if (_graph != null)
            {
                Note(uses, _graph.Topics, _graph.TopicType);
                Note(uses, _graph.Services, _graph.ServiceType);
                Note(uses, _graph.Actions, _graph.ActionType);
            }
            List<RobotType> types = new();
            foreach (KeyValuePair<string, List<string>> each in uses)
            {
                types.Add(new RobotType(each.Key, each.Value));
            }
            foreach (string name in new SortedSet<string>(_installed, StringComparer.Ordinal))
            {
                if (!uses.ContainsKey(name))
                {
                    types.Add(new RobotType(name, new string[0]));
                }
            }
            _types = types.ToArray();
            Tell();
        }

        private static void Note(
            SortedDictionary<string, List<string>> uses, IEnumerable<string> names, Func<string, string> typeOf)
        {
            foreach (string name in names)
            {
                string type = typeOf(name);
                List<string> known;
                if (type.Length == 0)
                {
                    continue; // several
                }
                if (!uses.TryGetValue(type, out known))
                {
                    uses[type] = known = new List<string>();
                }
                if (known.Count < MaxUses)
                {
                    known.Add(name);
                }
            }
        }

        private string Words()
        {
            if (!_client.Client.IsConnected)
            {
                return _client.Problem;
            }
            return _types.Length == 0 ? "connected, waiting for the types" : _refusal;
        }

        private void Tell()
        {
            if (Changed != null)
            {
                Changed();
            }
        }

        /// <summary>The answer of /rosapi/interfaces.</summary>
        private sealed class Interfaces : IMessage
        {
            public readonly List<string> Names = new();

            public string RosType => "rosapi_msgs/srv/Interfaces_Response";

            public void Read(JsonReader reader)
            {
                foreach (JsonValue name in JsonValue.Read(reader)["interfaces"].Items)
                {
                    Names.Add(name.AsString());
                }
            }

            public void Write(JsonWriter writer) => throw new NotSupportedException("an answer is only read");
        }
    }
}
