// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>The graph as the gateway tells it, kept up to date while anybody watches.</summary>
    internal sealed class GraphWatch
    {
        private readonly object _gate = new();
        private readonly GatewayClient _client;
        private readonly Listeners<RosGraph> _watchers;
        private volatile RosGraph _graph;
        private bool _isPosted;

        internal GraphWatch(GatewayClient client)
        {
            _client = client;
            _watchers = new Listeners<RosGraph>(client.Mailbox.ReportFault, "watcher of the graph");
        }

        /// <summary>The newest. Null while nobody watches, or none has come.</summary>
        internal RosGraph Graph => _graph;

        internal void Add(Action<RosGraph> watcher)
        {
            bool isFirst;
            lock (_gate)
            {
                isFirst = _watchers.Add(watcher);
            }
            if (isFirst)
            {
                Send(true);
            }
            else
            {
                Post(); // the new one also gets the known graph
            }
        }

        internal void Remove(Action<RosGraph> watcher)
        {
            bool wasLast;
            lock (_gate)
            {
                wasLast = _watchers.Remove(watcher);
                _graph = wasLast ? null : _graph;
            }
            if (wasLast)
            {
                Send(false);
            }
        }

        internal void Restore()
        {
            bool isWatched;
            lock (_gate)
            {
                isWatched = !_watchers.IsEmpty;
                _graph = null;
            }
            if (isWatched)
            {
                Send(true);
            }
        }

        /// <summary>A graph frame has come that no request asked for: all of it, or changes.</summary>
        internal void OnFrame(JsonReader reader)
        {
            JsonValue frame = JsonValue.Read(reader);
            JsonValue changes = frame["changes"];
            lock (_gate)
            {
                if (_watchers.IsEmpty)
                {
                    return; // it was on its way when the last watcher left
                }
                _graph = changes.Kind == JsonKind.Object
                    ? (_graph ?? new RosGraph()).With(changes)
                    : RosGraph.Read(frame);
            }
            Post();
        }

        // Only the newest graph matters, so one word in the mailbox is enough.
        private void Post()
        {
            lock (_gate)
            {
                if (_isPosted || _graph == null)
                {
                    return;
                }
                _isPosted = true;
            }
            _client.Mailbox.Post("the graph", Tell);
        }

        private void Tell()
        {
            RosGraph graph;
            lock (_gate)
            {
                _isPosted = false;
                graph = _graph;
            }
            if (graph != null)
            {
                _watchers.Call(graph);
            }
        }

        private void Send(bool watch) => _client.Outbox.Send("graph", null, frame => frame.Name("watch").Value(watch));
    }
}
