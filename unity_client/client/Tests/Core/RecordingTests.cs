// SPDX-License-Identifier: Apache-2.0
using NUnit.Framework;
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Messages.StdSrvs;

namespace Ros2Gateway.Tests
{
    /// <summary>A recording, through a live gateway that plays it.</summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class RecordingTests
    {
        private const string Refusal = "this is a recording, and nothing in it can be moved or called";

        [Test]
        public void NothingInItMovesAndTheGatewaySaysWhy()
        {
            using Live live = Live.Connected(Live.Recording);
            live.Client.Advertise<TwistMsg>("/cmd_vel").Publish(new TwistMsg());
            live.Until(() => live.Heard(Refusal), "for the refusal");
            Reply<TriggerResponse>? reply = null;
            live.Client.CallService<TriggerResponse>("/reset", new TriggerRequest(), answer => reply = answer);
            live.Until(() => reply.HasValue, "for the answer");
            StringAssert.StartsWith(Refusal, reply.Value.Error);
            GoalResult<FibonacciSequence>? end = null;
            live.Client.SendGoal<FibonacciSequence, FibonacciSequence>(
                "/turn", new FibonacciGoal { order = 1 }, (System.Action<FibonacciSequence>)null, result => end = result);
            live.Until(() => end.HasValue, "for the result");
            StringAssert.StartsWith(Refusal, end.Value.Error);
        }
    }
}
