// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>The transforms that a client watches: periodic lookups of the gateway.</summary>
    internal sealed class TransformWatches
    {
        private readonly object _gate = new object();
        private readonly Outbox _outbox;
        private readonly Clock _clock;
        private readonly Dictionary<string, TransformWatch> _watches = new Dictionary<string, TransformWatch>();

        internal TransformWatches(Outbox outbox, Clock clock)
        {
            _outbox = outbox;
            _clock = clock;
        }

        internal TransformWatch Add(string id, string targetFrame, string sourceFrame, double rateHz)
        {
            TransformWatch watch = new TransformWatch(this, _clock, id, targetFrame, sourceFrame, rateHz);
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
            JsonWriter frame = _outbox.Rent();
            frame.Begin("cancel_transform", watch.Id);
            frame.EndObject();
            _outbox.Post(frame);
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

        internal void OnFrame(string id, JsonReader reader)
        {
            TransformWatch watch = Find(id);
            if (watch != null) // else it was on its way when the watch ended
            {
                watch.OnFrame(reader);
            }
        }

        /// <summary>The gateway warns of a lookup, which it does.</summary>
        internal void OnWarning(string id, string errorText)
        {
            TransformWatch watch = Find(id);
            if (watch != null)
            {
                watch.OnProblem(errorText);
            }
        }

        /// <summary>The gateway refuses a lookup. Returns whether that is known already.</summary>
        internal bool OnRefused(string id, string errorText)
        {
            TransformWatch watch = Find(id);
            return watch != null && !watch.Refuse(errorText, _clock.Now);
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
                TransformWatch watch = null;
                return id != null && _watches.TryGetValue(id, out watch) ? watch : null;
            }
        }

        private TransformWatch[] All()
        {
            lock (_gate)
            {
                TransformWatch[] all = new TransformWatch[_watches.Count];
                _watches.Values.CopyTo(all, 0);
                return all;
            }
        }

        private void Ask(TransformWatch watch)
        {
            JsonWriter frame = _outbox.Rent();
            frame.Begin("lookup_transform", watch.Id);
            frame.Member("target_frame", watch.TargetFrame);
            frame.Member("source_frame", watch.SourceFrame);
            frame.Member("rate", watch.RateHz);
            frame.EndObject();
            _outbox.Post(frame);
        }
    }
}
