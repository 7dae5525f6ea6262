// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Threading;
using System.Threading.Tasks;
using Ros2Gateway.Json;
using Ros2Gateway.Messages.GeometryMsgs;

namespace Ros2Gateway
{
    /// <content>
    /// Answers to await, next to those by callback. Each task ends in <see cref="Pump"/>, and what awaits it goes on
    /// there: in Unity on the main thread. Never block that thread by Wait or Result. If nothing has ever called
    /// Pump, tasks fail after 10 seconds. A task that cannot
    /// succeed fails with a <see cref="GatewayException"/>: refused, too late, the connection lost, the client
    /// disposed. One whose token is cancelled is cancelled.
    /// </content>
    public sealed partial class GatewayClient
    {
        private readonly AwaitedTasks _awaited = new();
        private const string NoPump =
            "nothing pumps this client: call Pump() once per frame, or use the Client of a Gateway Connection";

        private readonly List<AwaitedReply<bool>> _connecting = new(); // one for each caller
        private int _connects; // ConnectAsync was called so many times, and has not ended
        private long _unpumpedSince; // the clock's, when something began to wait for the first pump
        private volatile bool _isSuspended; // disconnected for a while
        private volatile bool _isGreeted; // a gateway accepts a connection before it looks at its token

        /// <summary>
        /// Begins to connect unless that was done, and ends when the gateway has introduced itself. It tries until
        /// then, for an absent gateway may come. It fails if it refuses this client, or on <see cref="Disconnect"/>.
        /// </summary>
        /// <param name="cancellation">Ends the waiting, and the attempts if this call has begun them.</param>
        public Task ConnectAsync(CancellationToken cancellation = default(CancellationToken))
        {
            if (cancellation.IsCancellationRequested)
            {
                return Task.FromCanceled(cancellation);
            }
            bool hasBegun = State == ConnectionState.Disconnected || State == ConnectionState.Refused;
            Interlocked.Increment(ref _connects);
            Connect();
            AwaitedReply<bool> awaited = new(_awaited, "connect", cancellation);
            lock (_connecting)
            {
                _connecting.Add(awaited);
            }
            Mailbox.Post("ConnectAsync", TellConnecting); // it may be connected, or refused, already
            awaited.OnCancelled(() => Mailbox.Post("ConnectAsync", () =>
            {
                if (StopsConnecting(awaited) && hasBegun)
                {
                    Disconnect();
                }
                awaited.Cancel();
            }));
            return awaited.Task;
        }

        /// <summary>Calls a service.</summary>
        /// <param name="cancellation">Ends the waiting. ROS services themselves cannot be cancelled.</param>
        /// <param name="timeoutMilliseconds">0 for <see cref="GatewayOptions.CallMilliseconds"/>.</param>
        public Task<TResponse> CallServiceAsync<TResponse>(
            string service, IMessage request, CancellationToken cancellation = default(CancellationToken),
            int timeoutMilliseconds = 0)
            where TResponse : IMessage, new()
        {
            string name = Names.Absolute(service);
            return Asked<TResponse>(
                "call_service " + name, done => SendCall(name, request, done, timeoutMilliseconds), cancellation);
        }

        /// <summary>
        /// Sends a goal to an action server. Await what this returns for the result, or go through the feedback first.
        /// </summary>
        /// <param name="cancellation">Cancels the goal.</param>
        /// <param name="keep">Whether the goal goes on when this client leaves. Else it is cancelled then.</param>
        public GoalTask<TFeedback, TResult> SendGoalAsync<TFeedback, TResult>(
            string action, IMessage goal, CancellationToken cancellation = default(CancellationToken), bool keep = false)
            where TFeedback : IMessage, new()
            where TResult : IMessage, new()
        {
            GoalTask<TFeedback, TResult> task = new(
                _awaited, Names.Absolute(action), cancellation);
            if (!cancellation.IsCancellationRequested)
            {
                task.Follow(Goals.Send<TFeedback, TResult>(
                    Names.Absolute(action), goal, task.OnFeedback, task.OnResult, keep));
            }
            return task;
        }

        /// <summary>Asks for anything else that the gateway knows. The result is the whole frame of the answer.</summary>
        /// <param name="members">The members of the operation. Null for none.</param>
        /// <param name="cancellation">Ends the waiting.</param>
        /// <param name="timeoutMilliseconds">0 for <see cref="GatewayOptions.CallMilliseconds"/>.</param>
        public Task<JsonValue> RequestAsync(
            string op, JsonValue members, CancellationToken cancellation = default(CancellationToken),
            int timeoutMilliseconds = 0) =>
            Asked<JsonValue>(
                op, done => SendRequest(op, members, JsonValue.Read, done, timeoutMilliseconds), cancellation);

        /// <summary>Asks for the graph as it is now.</summary>
        public Task<RosGraph> GetGraphAsync(CancellationToken cancellation = default(CancellationToken)) => Asked<RosGraph>(
            "graph",
            done => SendRequest("graph", null, reader => RosGraph.Read(JsonValue.Read(reader)), done, 0),
            cancellation);

        /// <summary>Asks for the newest transform that takes points from the source into the target frame.</summary>
        /// <param name="cancellation">Ends the waiting.</param>
        /// <param name="timeoutMilliseconds">How long a transform that is not known yet is waited for.</param>
        public Task<TransformStampedMsg> LookupTransformAsync(
            string targetFrame, string sourceFrame, CancellationToken cancellation = default(CancellationToken),
            int timeoutMilliseconds = 1000)
        {
            JsonValue members = JsonValue.Object()
                .With("target_frame", targetFrame)
                .With("source_frame", sourceFrame)
                .With("timeout", timeoutMilliseconds / 1000.0);
            return Asked<TransformStampedMsg>(
                "lookup_transform",
                done => SendRequest(
                    "lookup_transform", members, reader => TransformWatch.Read(reader, new TransformStampedMsg()), done,
                    timeoutMilliseconds),
                cancellation);
        }

        private Task<T> Asked<T>(string what, Func<Action<Reply<T>>, string> send, CancellationToken cancellation) =>
            Awaited<T>(
                what,
                done =>
                {
                    string id = send(done);
                    return () => Requests.Forget(id);
                },
                cancellation);

        /// <summary>A task that ends in the pump.</summary>
        /// <param name="ask">Gets what takes the answer. Returns what gives it up: false if the answer is here.</param>
        internal Task<T> Awaited<T>(
            string what, Func<Action<Reply<T>>, Func<bool>> ask, CancellationToken cancellation)
        {
            if (cancellation.IsCancellationRequested)
            {
                return Task.FromCanceled<T>(cancellation);
            }
            AwaitedReply<T> awaited = new(_awaited, what, cancellation);
            Func<bool> forget = ask(awaited.Answer);
            awaited.OnCancelled(() =>
            {
                if (forget()) // else the answer waits for the pump already
                {
                    Mailbox.Post("a cancellation", awaited.Cancel);
                }
            });
            return awaited.Task;
        }

        private void Greeted()
        {
            _isGreeted = true;
            Mailbox.Post("ConnectAsync", TellConnecting);
        }

        // By the pump, with each change of state, and when someone begins to wait.
        private void TellConnecting()
        {
            ConnectionState state = State;
            if (state == ConnectionState.Connecting || state == ConnectionState.Waiting
                || (state == ConnectionState.Disconnected && _isSuspended)
                || (state == ConnectionState.Connected && !_isGreeted))
            {
                return;
            }
            AwaitedReply<bool>[] all;
            lock (_connecting)
            {
                if (_connecting.Count == 0)
                {
                    return;
                }
                all = _connecting.ToArray();
                _connecting.Clear();
            }
            Interlocked.Add(ref _connects, -all.Length);
            Reply<bool> reply = state == ConnectionState.Connected ? Reply<bool>.Of(true)
                : Reply<bool>.Failed(state == ConnectionState.Refused ? _link.LastError : "Disconnect was called");
            foreach (AwaitedReply<bool> awaited in all)
            {
                awaited.Answer(reply);
            }
        }

        private bool StopsConnecting(AwaitedReply<bool> awaited)
        {
            lock (_connecting)
            {
                if (!_connecting.Remove(awaited))
                {
                    return false;
                }
            }
            Interlocked.Decrement(ref _connects);
            return true;
        }

        // A task ends in the pump. Without a pump it fails, because nothing else could say so.
        private void MissPump(long now)
        {
            if (Mailbox.WasPumped)
            {
                return;
            }
            if (!_awaited.IsAny)
            {
                _unpumpedSince = now;
            }
            else if (now - _unpumpedSince >= _options.UnpumpedMilliseconds)
            {
                _awaited.Abandon(NoPump);
            }
        }
    }
}
