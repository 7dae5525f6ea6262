// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>The requests without an answer yet. Every request is answered once.</summary>
    internal sealed class Requests
    {
        // As many calls as the gateway keeps for one client, those under way and those that wait.
        private const int MaxPending = 272;

        // The gateway answers in time by itself. This is for one that does not.
        private const long GraceMilliseconds = 5000;

        private readonly object _gate = new object();
        private readonly Outbox _outbox;
        private readonly Mailbox _mailbox;
        private readonly Reports _reports;
        private readonly Clock _clock;
        private readonly Dictionary<string, Request> _pending = new Dictionary<string, Request>();
        private long _count;

        internal Requests(Outbox outbox, Mailbox mailbox, Reports reports, Clock clock)
        {
            _outbox = outbox;
            _mailbox = mailbox;
            _reports = reports;
            _clock = clock;
        }

        internal int Count
        {
            get
            {
                lock (_gate)
                {
                    return _pending.Count;
                }
            }
        }

        /// <summary>Sends a request. *Done* is called while the client is pumped. Returns its id.</summary>
        /// <param name="what">Its name, for people: "call_service /reset".</param>
        /// <param name="write">Writes the members after op and id.</param>
        /// <param name="read">Reads the answer: its values, or the whole frame where it has none.</param>
        /// <param name="isAwaited">Whether *done* throws what went wrong, where the application catches it.</param>
        internal string Send<T>(
            string op, string what, Action<JsonWriter> write, Func<JsonReader, T> read,
            Action<Reply<T>> done, long timeoutMilliseconds, bool isAwaited = false)
        {
            Request<T> request = new Request<T>(
                what, _clock.Now + timeoutMilliseconds + GraceMilliseconds, read, done, isAwaited);
            string id;
            lock (_gate)
            {
                _count++;
                id = "r" + _count;
                if (_pending.Count >= MaxPending)
                {
                    Fail(request, "at most " + MaxPending + " requests at once");
                    return id;
                }
                _pending[id] = request;
            }
            JsonWriter frame = _outbox.Rent();
            try
            {
                frame.Begin(op, id);
                write(frame);
                frame.EndObject();
            }
            catch (Exception error)
            {
                // A message may be a class of the application's, which may throw anything.
                Fail(id, error.Message);
                return id;
            }
            string refusal = _outbox.Post(frame);
            if (refusal != null)
            {
                Fail(id, refusal);
            }
            return id;
        }

        /// <summary>Gives a request up: its answer will be ignored. False if the answer, or a failure, is here.</summary>
        internal bool Forget(string id)
        {
            return Take(id) != null;
        }

        internal bool IsPending(string id)
        {
            lock (_gate)
            {
                return id != null && _pending.ContainsKey(id);
            }
        }

        /// <summary>The answer has come: *reader* stands before it.</summary>
        internal void Answer(string id, JsonReader reader)
        {
            Request request = Take(id);
            if (request == null)
            {
                return; // it was too late
            }
            try
            {
                _mailbox.Post(request.What, request.Read(reader));
            }
            catch (Exception error)
            {
                // Not only a JsonFormatException: the message may be a class of the application's.
                Fail(request, "answer cannot be read: " + error.Message);
            }
        }

        /// <summary>The answer is words that say why it is missing.</summary>
        internal void Fail(string id, string errorText)
        {
            Request request = Take(id);
            if (request != null)
            {
                Fail(request, errorText);
            }
        }

        /// <summary>Nothing will be answered any more on this connection.</summary>
        internal void FailAll(string errorText)
        {
            List<Request> all;
            lock (_gate)
            {
                all = new List<Request>(_pending.Values);
                _pending.Clear();
            }
            foreach (Request request in all)
            {
                Fail(request, errorText);
            }
        }

        internal void Tick(long now)
        {
            List<string> late = null;
            lock (_gate)
            {
                foreach (KeyValuePair<string, Request> pending in _pending)
                {
                    if (now >= pending.Value.Deadline)
                    {
                        late = late ?? new List<string>();
                        late.Add(pending.Key);
                    }
                }
            }
            if (late != null)
            {
                foreach (string id in late)
                {
                    Fail(id, "no answer from the gateway in time");
                }
            }
        }

        private Request Take(string id)
        {
            lock (_gate)
            {
                Request request;
                if (id != null && _pending.TryGetValue(id, out request))
                {
                    _pending.Remove(id);
                    return request;
                }
                return null;
            }
        }

        private void Fail(Request request, string errorText)
        {
            _reports.Failure(request.What, errorText, request.IsAwaited);
            _mailbox.Post(request.What, request.Failed(errorText));
        }

        private abstract class Request
        {
            internal readonly string What;
            internal readonly long Deadline;
            internal readonly bool IsAwaited;

            protected Request(string what, long deadline, bool isAwaited)
            {
                What = what;
                Deadline = deadline;
                IsAwaited = isAwaited;
            }

            internal abstract Action Read(JsonReader reader);

            internal abstract Action Failed(string errorText);
        }

        private sealed class Request<T> : Request
        {
            private readonly Func<JsonReader, T> _read;
            private readonly Action<Reply<T>> _done;

            internal Request(
                string what, long deadline, Func<JsonReader, T> read, Action<Reply<T>> done, bool isAwaited)
                : base(what, deadline, isAwaited)
            {
                _read = read;
                _done = done;
            }

            internal override Action Read(JsonReader reader)
            {
                Reply<T> reply = Reply<T>.Of(_read(reader));
                return () => Tell(reply);
            }

            internal override Action Failed(string errorText)
            {
                return () => Tell(Reply<T>.Failed(errorText));
            }

            private void Tell(Reply<T> reply)
            {
                if (_done != null)
                {
                    _done(reply);
                }
            }
        }
    }
}
