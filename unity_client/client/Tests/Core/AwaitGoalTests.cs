// SPDX-License-Identifier: Apache-2.0
using System;
using System.Threading;
using System.Threading.Tasks;
using NUnit.Framework;
using Ros2Gateway.Json;

namespace Ros2Gateway.Tests
{
    /// <summary>Goals that are awaited, with their feedback, from a server by plain rclpy.</summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class AwaitGoalTests
    {
        private const string Action = "/fibonacci";
        private const int Endless = 1000; // from this order on the server goes on until it is cancelled
        private const int Rejected = 0; // an order that the server does not take
        private const int Aborted = -1;

        [TestCase(true)]
        [TestCase(false)]
        public void FeedbackComesOneAfterTheOtherAndThenTheResult(bool usesThreads)
        {
            using Live live = Live.Connected(change: options => options.UsesThreads = usesThreads);
            Await(live, () => FollowToTheEnd(live.Client));
        }

        private static async Task FollowToTheEnd(GatewayClient client)
        {
            int thread = Thread.CurrentThread.ManagedThreadId;
            await ServerOf(client);
            GoalTask<FibonacciSequence, FibonacciSequence> goal = Send(client, 5);
            Assert.AreEqual(GoalStatus.Executing, goal.Status);
            int count = 0;
            int length = 0;
            while (await goal.MoveNextAsync())
            {
                Assert.AreEqual(thread, Thread.CurrentThread.ManagedThreadId);
                Assert.Greater(goal.Current.sequence.Length, length, "the newest");
                length = goal.Current.sequence.Length;
                count++;
            }
            Assert.Greater(count, 0);
            GoalResult<FibonacciSequence> end = await goal;
            Assert.AreEqual(thread, Thread.CurrentThread.ManagedThreadId);
            Assert.IsTrue(end.Succeeded);
            Assert.AreEqual(GoalStatus.Succeeded, goal.Status);
            Assert.AreEqual(5, end.Value.sequence[5]);
            Assert.AreSame(end.Value, (await goal.Result).Value);
            Assert.IsFalse(await goal.MoveNextAsync(), "there is none after the end");
            Assert.AreEqual(0, client.PendingRequests);
        }

        [Test]
        public void ATokenCancelsTheGoalItself()
        {
            using (Live live = Live.Connected())
            using (CancellationTokenSource cancellation = new())
            {
                Await(live, () => ServerOf(live.Client));
                GoalTask<FibonacciSequence, FibonacciSequence> goal = Send(live.Client, Endless, cancellation.Token);
                Await(live, () => goal.MoveNextAsync());
                cancellation.Cancel();
                Assert.AreEqual(GoalStatus.Canceling, goal.Status);
                Assert.IsFalse(goal.Result.IsCompleted, "until the server has ended it");
                Task feedback = ToTheEnd(goal);
                live.Until(() => goal.Result.IsCompleted && feedback.IsCompleted, "for the end");
                Assert.IsTrue(goal.Result.IsCanceled);
                Assert.IsTrue(feedback.IsCanceled);
                Assert.AreEqual(GoalStatus.Canceled, goal.Status);
                Assert.AreEqual(0, live.Client.PendingRequests);
            }
        }

        [Test]
        public void AGoalOfATypeThatHasNoClassIsATree()
        {
            using Live live = Live.Connected();
            Await(live, () => ServerOf(live.Client));
            GoalTask<DynamicMessage, DynamicMessage> goal = live.Client.SendGoalAsync<DynamicMessage, DynamicMessage>(
                Action, new DynamicMessage { Value = JsonValue.Object().With("order", 5) });
            Await(live, () => goal.MoveNextAsync());
            Assert.AreEqual(JsonKind.Array, goal.Current.Value["sequence"].Kind);
            Await(live, () => goal.Result);
            Assert.AreEqual(5, goal.Result.Result.Value.Value["sequence"][5].AsLong(0));
        }

        [Test]
        public void AGoalThatIsCancelledWithoutATokenAndOneThatIsAbortedHaveResults()
        {
            using Live live = Live.Connected();
            Await(live, () => ServerOf(live.Client));
            GoalTask<FibonacciSequence, FibonacciSequence> goal = Send(live.Client, Endless);
            Await(live, () => goal.MoveNextAsync());
            goal.Cancel();
            Await(live, () => goal.Result);
            Assert.AreEqual(GoalStatus.Canceled, goal.Result.Result.Status);
            goal = Send(live.Client, Aborted);
            Await(live, () => goal.Result);
            Assert.AreEqual(GoalStatus.Aborted, goal.Result.Result.Status);
            Assert.IsNotNull(goal.Result.Result.Value);
        }

        [Test]
        public void ARejectedGoalFailsForWhoAwaitsItAndForWhoGoesThroughItsFeedback()
        {
            using Live live = Live.Connected();
            Await(live, () => ServerOf(live.Client));
            GoalTask<FibonacciSequence, FibonacciSequence> goal = Send(live.Client, Rejected);
            Task feedback = ToTheEnd(goal);
            foreach (Task task in new[] { goal.Result, feedback })
            {
                string words = Assert.Throws<GatewayException>(() => Await(live, () => task)).Message;
                StringAssert.StartsWith("goal of /fibonacci: ", words);
                StringAssert.Contains("rejected", words);
            }
        }

        [Test]
        public void ALostConnectionFailsAGoal()
        {
            using Live live = Live.Connected(Live.Rogue, "/through");
            Await(live, () => ServerOf(live.Client));
            GoalTask<FibonacciSequence, FibonacciSequence> goal = Send(live.Client, Endless);
            Await(live, () => goal.MoveNextAsync());
            live.Client.Request("cut", null, null);
            StringAssert.Contains(
                "lost", Assert.Throws<GatewayException>(() => Await(live, () => ToTheEnd(goal))).Message);
            Assert.Throws<GatewayException>(() => Await(live, () => goal.Result));
            Assert.AreEqual(GoalStatus.Unknown, goal.Status);
        }

        [Test]
        public void FeedbackIsForOneReader()
        {
            using (Live live = Live.Connected())
            using (CancellationTokenSource cancellation = new())
            {
                GoalTask<FibonacciSequence, FibonacciSequence> goal = Send(live.Client, Endless, cancellation.Token);
                Task<bool> first = goal.MoveNextAsync();
                Assert.Throws<InvalidOperationException>(() => goal.MoveNextAsync());
                cancellation.Cancel();
                live.Until(() => first.IsCompleted, "for feedback, or the end");
            }
        }

        // The gateway may just have started, and not know the action yet.
        private static async Task ServerOf(GatewayClient client)
        {
            RosGraph graph = await client.GetGraphAsync();
            while (graph.ActionType(Action).Length == 0)
            {
                graph = await client.GetGraphAsync();
            }
        }

        private static async Task ToTheEnd(GoalTask<FibonacciSequence, FibonacciSequence> goal)
        {
            while (await goal.MoveNextAsync())
            {
            }
        }

        private static GoalTask<FibonacciSequence, FibonacciSequence> Send(
            GatewayClient client, int order, CancellationToken cancellation = default(CancellationToken)) =>
            client.SendGoalAsync<FibonacciSequence, FibonacciSequence>(
                Action, new FibonacciGoal { order = order }, cancellation);

        private static void Await(Live live, Func<Task> begin)
        {
            Task task = begin();
            live.Until(() => task.IsCompleted, "for a task");
            task.GetAwaiter().GetResult();
        }
    }
}
