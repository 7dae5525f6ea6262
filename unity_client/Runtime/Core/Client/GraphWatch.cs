// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>The graph as the gateway tells it, kept up to date while anybody watches.</summary>
    internal sealed class GraphWatch
    {
        private readonly object _gate = new object();
        private readonly Outbox _outbox;
        private readonly Mailbox _mailbox;
        private readonly Listeners<RosGraph> _watchers;
        private RosGraph _graph;
        private bool _isPosted;

        internal GraphWatch(Outbox outbox, Mailbox mailbox)
        {
            _outbox = outbox;
            _mailbox = mailbox;
            _watchers = new Listeners<RosGraph>(mailbox.ReportFault, "watcher of the graph");
        }

        /// <summary>The newest. Null while nobody watches, or none has come.</summary>
        internal RosGraph Graph
        {
            get
            {
                lock (_gate)
                {
                    return _graph;
                }
            }
        }

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
            _mailbox.Post("the graph", Tell);
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

        private void Send(bool watch)
        {
            JsonWriter frame = _outbox.Rent();
            frame.Begin("graph");
            frame.Member("watch", watch);
            frame.EndObject();
            _outbox.Post(frame);
        }
    }
}
