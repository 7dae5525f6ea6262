// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;

namespace Ros2Gateway.Editor
{
    /// <summary>
    /// The present topics with their types for a dropdown, or why they are missing.
    /// </summary>
    public sealed class GraphDropdown : IDisposable
    {
        private static readonly string[] Nothing = new string[0];

        private readonly EditorClient _client;
        private RosGraph _graph;
        private string[] _topics = Nothing;
        private string _problem;

        /// <summary>Begins to connect, to where these options say.</summary>
        public GraphDropdown(GatewayOptions options)
        {
            _client = new EditorClient(options);
            _client.Client.WatchGraph(Take);
            _problem = Words();
        }

        /// <summary>The content has changed.</summary>
        public event Action Changed;

        /// <summary>
        /// The topics in the order of their names. The last known ones while the connection is lost.
        /// </summary>
        public IList<string> Topics => _topics;

        /// <summary>
        /// Why the topics are missing or old, in words. Empty if they are as they are now. Changes in
        /// <see cref="Pump"/> only: the editor draws in two passes, which must agree.
        /// </summary>
        public string Problem => _problem;

        /// <summary>
        /// The type of a topic. Empty if there is no such topic, or if it has several types.
        /// </summary>
        public string TypeOf(string topic) => _graph == null || string.IsNullOrEmpty(topic) ? "" : _graph.TopicType(topic);

        /// <summary>Calls what waits. From the editor's update.</summary>
        public void Pump()
        {
            _client.Pump();
            string problem = Words();
            if (problem != _problem)
            {
                _problem = problem;
                Tell();
            }
        }

        /// <summary>Disconnects.</summary>
        public void Dispose() => _client.Dispose();

        private void Take(RosGraph graph)
        {
            _graph = graph;
            _topics = new List<string>(graph.Topics).ToArray();
            Tell();
        }

        private string Words()
        {
            if (!_client.Client.IsConnected)
            {
                return _client.Problem;
            }
            if (_graph == null)
            {
                return "connected, waiting for the graph";
            }
            return _topics.Length == 0 ? "no topics at " + _client.Address : "";
        }

        private void Tell()
        {
            if (Changed != null)
            {
                Changed();
            }
        }
    }
}
