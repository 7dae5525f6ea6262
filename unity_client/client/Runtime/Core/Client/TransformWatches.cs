// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;
using System.Linq;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>The transforms that a client watches: periodic lookups of the gateway.</summary>
    internal sealed class TransformWatches
    {
        private readonly object _gate = new();
        private readonly GatewayClient _client;
        private readonly Dictionary<string, TransformWatch> _watches = new();

        internal TransformWatches(GatewayClient client) => _client = client;

        internal TransformWatch Add(string id, string targetFrame, string sourceFrame, double rateHz)
        {
            TransformWatch watch = new(this, _client.Clock, id, targetFrame, sourceFrame, rateHz);
            lock (_gate)
            {
                _watches[id] = watch;
            }
            Ask(watch);
            return watch;
        }

        internal void Remove(TransformWatch watch)
        {
            lock (_gate)
            {
                if (!_watches.Remove(watch.Id))
                {
                    return;
                }
            }
            _client.Outbox.Send("cancel_transform", watch.Id);
        }

        internal void Restore()
        {
            foreach (TransformWatch watch in All())
            {
                Ask(watch);
            }
        }

        internal void OnDown()
        {
            foreach (TransformWatch watch in All())
            {
                watch.OnProblem("not connected");
            }
        }

        internal void OnFrame(string id, JsonReader reader) =>
            Find(id)?.OnFrame(reader); // null if it was on its way when the watch ended

        /// <summary>The gateway warns of a lookup, which it does.</summary>
        internal void OnWarning(string id, string errorText) => Find(id)?.OnProblem(errorText);

        /// <summary>The gateway refuses a lookup. Returns whether that is known already.</summary>
        internal bool OnRefused(string id, string errorText)
        {
            TransformWatch watch = Find(id);
            return watch != null && !watch.Refuse(errorText, _client.Clock.Now);
        }

        /// <summary>Asks again for what was refused, from time to time: others may have ended by then.</summary>
        internal void Tick(long now)
        {
            lock (_gate) // or the end of a watch could overtake its question
            {
                foreach (TransformWatch watch in _watches.Values)
                {
                    if (watch.AsksAgain(now))
                    {
                        Ask(watch);
                    }
                }
            }
        }

        private TransformWatch Find(string id)
        {
            lock (_gate)
            {
                return id != null && _watches.TryGetValue(id, out TransformWatch watch) ? watch : null;
            }
        }

        private TransformWatch[] All()
        {
            lock (_gate)
            {
                return _watches.Values.ToArray();
            }
        }

        private void Ask(TransformWatch watch) => _client.Outbox.Send("lookup_transform", watch.Id, frame =>
        {
            frame.Name("target_frame").Value(watch.TargetFrame);
            frame.Name("source_frame").Value(watch.SourceFrame);
            frame.Name("rate").Value(watch.RateHz);
        });
    }
}
