// SPDX-License-Identifier: Apache-2.0
using System;
using System.Threading;
using System.Threading.Tasks;
using NUnit.Framework;
using Ros2Gateway.Json;
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Messages.StdSrvs;

namespace Ros2Gateway.Tests
{
    /// <summary>Awaiting code goes on where the client is pumped, with the answer or with the reason.</summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class AwaitTests
    {
        private const string Robot = "/simulated_robot";

        [TestCase(true)]
        [TestCase(false)]
        public void EverythingIsAwaitedOnThePumpsThread(bool usesThreads)
        {
            using Live live = new(Live.Gateway, "", options => options.UsesThreads = usesThreads);
            Await(live, () => AskForAll(live.Client));
        }

        private static async Task AskForAll(GatewayClient client)
        {
            int thread = Thread.CurrentThread.ManagedThreadId;
            await client.ConnectAsync();
            Assert.IsTrue(client.IsConnected);
            await client.ConnectAsync();
            Assert.AreEqual(thread, Thread.CurrentThread.ManagedThreadId);
            RosGraph graph = await client.GetGraphAsync();
            while (graph.TopicType("/odom").Length == 0 || graph.ServiceType("/motor_power").Length == 0)
            {
                graph = await client.GetGraphAsync(); // the gateway may just have started
            }
            Assert.AreEqual(thread, Thread.CurrentThread.ManagedThreadId);
            Assert.AreEqual("nav_msgs/msg/Odometry", graph.TopicType("/odom"));
            SetBoolResponse power = await client.CallServiceAsync<SetBoolResponse>(
                "/motor_power", new SetBoolRequest { data = true });
            Assert.IsTrue(power.success);
            TransformStampedMsg laser = await client.LookupTransformAsync(
                "base_link", "base_scan", default(CancellationToken), 60000);
            Assert.AreEqual("base_link", laser.header.frame_id);
            Assert.AreEqual("base_scan", laser.child_frame_id);
            Assert.AreEqual(0.122, laser.transform.translation.z, 1e-9);
            string[] names = await client.ListParametersAsync(Robot);
            CollectionAssert.Contains(names, "use_sim_time");
            JsonValue values = await client.GetParametersAsync(Robot, new[] { "use_sim_time" });
            Assert.IsFalse(values["use_sim_time"].AsBool(true));
            JsonValue results = await client.SetParametersAsync(Robot, JsonValue.Object().With("use_sim_time", 7));
            Assert.IsFalse(results["use_sim_time"]["successful"].AsBool(true));
            JsonValue words = await client.DescribeParametersAsync(Robot, new[] { "use_sim_time" });
            Assert.AreEqual("bool", words["use_sim_time"]["type"].AsString(""));
            JsonValue hello = await client.RequestAsync("hello", null);
            Assert.AreEqual("ros2-json-gateway", hello["server"].AsString(""));
            Assert.AreEqual(thread, Thread.CurrentThread.ManagedThreadId);
            Assert.AreEqual(0, client.PendingRequests);
        }

        [Test]
        public void WhatTheGatewayRefusesFailsInItsWords()
        {
            using Live live = Live.Connected();
            Assert.AreEqual(
                "call_service /nowhere: service /nowhere does not exist",
                Failure(live, () => live.Client.CallServiceAsync<TriggerResponse>("nowhere", new TriggerRequest())));
            StringAssert.Contains("nobody", Failure(live, () => live.Client.ListParametersAsync("/nobody")));
            StringAssert.Contains(
                "lookup_transform: frame 'moon' is unknown",
                Failure(live, () => live.Client.LookupTransformAsync("base_link", "moon", default(CancellationToken), 1)));
        }

        [Test]
        public void WhatTheApplicationHandlesIsNoErrorInTheLogToo()
        {
            using (Live live = Live.Connected())
            {
                Failure(live, () => live.Client.CallServiceAsync<TriggerResponse>("nowhere", new TriggerRequest()));
                Failure(live, () => live.Client.RequestAsync("nothing", null));
                Failure(live, () => Send(live, 0, default(CancellationToken)).Result);
                live.Until(() => live.Heard("/nowhere does not exist"), "for the events");
                string told = null;
                live.Client.CallService<TriggerResponse>("/nobody", new TriggerRequest(), reply => told = reply.Error);
                live.Until(() => told != null && live.Heard("/nobody does not exist"), "for the callback and the event");
                Assert.IsFalse(live.Events.Exists(IsError), string.Join(" | ", live.Events));
                live.Client.CallService<TriggerResponse>("/without", new TriggerRequest(), null);
                live.Until(() => live.Events.Exists(IsError), "for the error of a call that nobody handles");
            }
            using Live refusing = new(Live.Rogue, "/refuses");
            Failure(refusing, () => refusing.Client.ConnectAsync());
            refusing.Until(() => refusing.Heard("the token is wrong"), "for the event");
            Assert.IsFalse(refusing.Events.Exists(IsError), string.Join(" | ", refusing.Events));
        }

        [Test]
        public void WithoutAPumpATaskSaysSo()
        {
            using Live live = new(Live.Gateway, "", options => options.UnpumpedMilliseconds = 100);
            Task task = live.Client.ConnectAsync();
            AggregateException error = Assert.Throws<AggregateException>(() => task.Wait(Live.TimeoutMilliseconds));
            StringAssert.StartsWith("connect: nothing pumps this client: call Pump()", error.InnerException.Message);
            live.Client.Pump();
            Await(live, () => live.Client.ConnectAsync());
        }

        [Test]
        public void WithoutAConnectionAndWithoutAClientItFails()
        {
            using Live live = new(Live.Gateway);
            StringAssert.Contains("not connected", Failure(live, () => live.Client.GetGraphAsync()));
            Task connecting = live.Client.ConnectAsync();
            live.Client.Disconnect();
            Assert.AreEqual("connect: Disconnect was called", Failure(live, () => connecting));
            Await(live, () => live.Client.ConnectAsync());
            Task waiting = live.Client.CallServiceAsync<TriggerResponse>("/stop_motor", new TriggerRequest());
            Task again = live.Client.ConnectAsync();
            live.Client.Dispose();
            Assert.AreEqual("call_service /stop_motor: the client was disposed", Failure(live, () => waiting));
            Assert.AreEqual("connect: the client was disposed", Failure(live, () => again));
            Assert.AreEqual("graph: the client was disposed", Failure(live, () => live.Client.GetGraphAsync()));
            Assert.AreEqual(
                "goal of /fibonacci: the client was disposed",
                Failure(live, () => Send(live, 5, default(CancellationToken)).Result));
        }

        [Test]
        public void ConnectingFailsWhereTheGatewayRefusesAndWhereThereIsNoAddress()
        {
            using Live live = new(Live.Rogue, "/refuses");
            StringAssert.Contains("the token is wrong", Failure(live, () => live.Client.ConnectAsync()));
            live.Client.Address = "robot";
            StringAssert.Contains(
                "address 'robot': expected ws://HOST:PORT", Failure(live, () => live.Client.ConnectAsync()));
        }

        [Test]
        public void ACancelledTokenEndsTheAttemptsThatItsCallBegan()
        {
            using (Live live = new(Live.Deaf))
            using (CancellationTokenSource cancellation = new())
            using (CancellationTokenSource other = new())
            {
                Task first = live.Client.ConnectAsync(cancellation.Token);
                Task second = live.Client.ConnectAsync(other.Token);
                other.Cancel();
                AssertCancelled(live, second);
                Assert.AreEqual(ConnectionState.Connecting, live.Client.State);
                Assert.IsFalse(first.IsCompleted);
                cancellation.Cancel();
                AssertCancelled(live, first);
                Assert.AreEqual(ConnectionState.Disconnected, live.Client.State);
            }
        }

        [Test]
        public void ACallIsGivenUpWithItsTokenFromAnyThreadAndGoesOnWhereItIsPumped()
        {
            using (Live live = Live.Connected())
            using (Live provider = Live.Connected())
            using (CancellationTokenSource cancellation = new())
            {
                provider.Client.AdvertiseService<TriggerRequest, TriggerResponse>(
                    "/awaited_in_vain", TriggerRequest.Service, request => new TriggerResponse()); // is never pumped
                provider.Until(() => provider.Client.RosClock.IsKnown, "for the first pong");
                Task<int> ended = ThreadOfEnd(live.Client.CallServiceAsync<TriggerResponse>(
                    "/awaited_in_vain", new TriggerRequest(), cancellation.Token));
                Thread canceller = new(cancellation.Cancel);
                canceller.Start();
                canceller.Join();
                Assert.IsFalse(ended.IsCompleted, "goes on in the pump only");
                Assert.AreEqual(0, live.Client.PendingRequests);
                Await(live, () => ended);
                Assert.AreEqual(Thread.CurrentThread.ManagedThreadId, ended.Result);
            }
        }

        [Test]
        public void ATokenThatIsCancelledAlreadySendsNothing()
        {
            using Live live = Live.Connected();
            CancellationToken cancelled = new(true);
            GoalTask<FibonacciSequence, FibonacciSequence> goal = Send(live, 5, cancelled);
            Task[] all =
            {
                live.Client.GetGraphAsync(cancelled), live.Client.ListParametersAsync(Robot, cancelled),
                live.Client.ConnectAsync(cancelled), goal.Result, goal.MoveNextAsync(),
            };
            Assert.IsTrue(Array.TrueForAll(all, task => task.IsCanceled), "at once");
            goal.Cancel();
            Assert.AreEqual(GoalStatus.Unknown, goal.Status);
            Assert.AreEqual(0, live.Client.PendingRequests);
        }

        [Test]
        public void ALostConnectionFailsWhatIsAwaited()
        {
            using (Live live = Live.Connected(Live.Rogue, "/through"))
            using (Live provider = Live.Connected())
            {
                provider.Client.AdvertiseService<TriggerRequest, TriggerResponse>(
                    "/awaited_and_cut", TriggerRequest.Service, request => new TriggerResponse()); // is never pumped
                provider.Until(() => provider.Client.RosClock.IsKnown, "for the first pong");
                Task call = live.Client.CallServiceAsync<TriggerResponse>("/awaited_and_cut", new TriggerRequest());
                live.Client.Request("cut", null, null);
                string words = Failure(live, () => call);
                StringAssert.StartsWith("call_service /awaited_and_cut: connection to ws://", words);
                StringAssert.Contains("lost", words);
            }
        }

        private static bool IsError(GatewayEvent happened) => happened.Level == EventLevel.Error;

        private static async Task<int> ThreadOfEnd(Task task)
        {
            try
            {
                await task;
            }
            catch (OperationCanceledException)
            {
                return Thread.CurrentThread.ManagedThreadId;
            }
            return 0;
        }

        private static GoalTask<FibonacciSequence, FibonacciSequence> Send(
            Live live, int order, CancellationToken cancellation) =>
            live.Client.SendGoalAsync<FibonacciSequence, FibonacciSequence>(
                "/fibonacci", new FibonacciGoal { order = order }, cancellation);

        private static void Await(Live live, Func<Task> begin)
        {
            Task task = begin();
            live.Until(() => task.IsCompleted, "for a task");
            task.GetAwaiter().GetResult();
        }

        private static string Failure(Live live, Func<Task> begin) =>
            Assert.Throws<GatewayException>(() => Await(live, begin)).Message;

        private static void AssertCancelled(Live live, Task task)
        {
            live.Until(() => task.IsCompleted, "for a task to be cancelled");
            Assert.IsTrue(task.IsCanceled, task.Status.ToString());
        }
    }
}
