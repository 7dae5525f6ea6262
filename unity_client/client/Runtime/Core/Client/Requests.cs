// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Linq;
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

        private readonly object _gate = new();
        private readonly GatewayClient _client;
        private readonly Dictionary<string, Request> _pending = new();
        private long _count;

        internal Requests(GatewayClient client) => _client = client;

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
        /// <param name="isHandled">Whether *done*, if it is there, hands what went wrong to the application.</param>
        internal string Send<T>(
            string op, string what, Action<JsonWriter> write, Func<JsonReader, T> read,
            Action<Reply<T>> done, long timeoutMilliseconds, bool isHandled = true)
        {
            Request request = new()
            {
                What = what,
                Deadline = _client.Clock.Now + timeoutMilliseconds + GraceMilliseconds,
                IsHandled = isHandled && done != null,
                Read = reader =>
                {
                    Reply<T> reply = Reply<T>.Of(read(reader));
                    return () => done?.Invoke(reply);
                },
                Failed = errorText => () => done?.Invoke(Reply<T>.Failed(errorText)),
            };
            string id;
            lock (_gate)
            {
                id = "r" + ++_count;
                if (_pending.Count >= MaxPending)
                {
                    Fail(request, "at most " + MaxPending + " requests at once");
                    return id;
                }
                _pending[id] = request;
            }
            string refusal;
            try
            {
                refusal = _client.Outbox.Send(op, id, write);
            }
            catch (Exception error)
            {
                refusal = error.Message; // a message may be a class of the application's, which may throw anything
            }
            if (refusal != null)
            {
                Fail(id, refusal);
            }
            return id;
        }

        /// <summary>Gives a request up: its answer will be ignored. False if the answer, or a failure, is here.</summary>
        internal bool Forget(string id) => Take(id) != null;

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
                _client.Mailbox.Post(request.What, request.Read(reader));
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
            foreach (string id in Late(now))
            {
                Fail(id, "no answer from the gateway in time");
            }
        }

        private string[] Late(long now)
        {
            lock (_gate)
            {
                return _pending.Count == 0 ? Array.Empty<string>()
                    : _pending.Where(pending => now >= pending.Value.Deadline).Select(pending => pending.Key).ToArray();
            }
        }

        private Request Take(string id)
        {
            lock (_gate)
            {
                return id != null && _pending.TryGetValue(id, out Request request) && _pending.Remove(id) ? request : null;
            }
        }

        private void Fail(Request request, string errorText)
        {
            _client.Reports.Failure(request.What, errorText, request.IsHandled);
            _client.Mailbox.Post(request.What, request.Failed(errorText));
        }

        private sealed class Request
        {
            internal string What;
            internal long Deadline;
            internal bool IsHandled;
            internal Func<JsonReader, Action> Read;
            internal Func<string, Action> Failed;
        }
    }
}
