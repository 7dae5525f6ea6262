// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;
using NUnit.Framework;
using Ros2Gateway.Messages.StdSrvs;

namespace Ros2Gateway.Tests
{
    /// <summary>Actions, through a live gateway, from a server by plain rclpy.</summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class ActionTests
    {
        private const string Action = "/fibonacci";
        private const int Endless = 1000; // from this order on the server goes on until it is cancelled
        private const int Rejected = 0; // an order that the server does not take

        [Test]
        public void AGoalIsReachedWithFeedbackOnTheWay()
        {
            using Live live = Live.Connected();
            List<FibonacciSequence> feedback = new();
            GoalResult<FibonacciSequence> end = Reached(live, feedback);
            Assert.AreEqual(GoalStatus.Succeeded, end.Status, end.Error);
            CollectionAssert.AreEqual(new[] { 0, 1, 1, 2, 3, 5 }, Start(end.Value.sequence, 6));
            Assert.Greater(feedback.Count, 0);
        }

        [Test]
        public void ACancelledGoalEndsAsCanceled()
        {
            using Live live = Live.Connected();
            Reached(live, new List<FibonacciSequence>());
            int heard = 0;
            GoalResult<FibonacciSequence>? end = null;
            Goal goal = live.Client.SendGoal<FibonacciSequence, FibonacciSequence>(
                Action, new FibonacciGoal { order = Endless }, feedback => heard++, result => end = result);
            live.Until(() => heard > 0, "for feedback");
            goal.Cancel();
            Assert.AreEqual(GoalStatus.Canceling, goal.Status);
            live.Until(() => end.HasValue, "for the result");
            Assert.AreEqual(GoalStatus.Canceled, end.Value.Status, end.Value.Error);
            Assert.IsTrue(goal.IsDone);
            goal.Cancel();
            Assert.AreEqual(GoalStatus.Canceled, goal.Status);
        }

        [Test]
        public void ARejectedGoalIsToldInWords()
        {
            using Live live = Live.Connected();
            Reached(live, new List<FibonacciSequence>());
            GoalResult<FibonacciSequence> end = Send(live, new FibonacciGoal { order = Rejected }, null);
            Assert.AreEqual(GoalStatus.Unknown, end.Status);
            StringAssert.Contains("rejected", end.Error);
            Assert.IsNull(end.Value);
        }

        [Test]
        public void AnActionOfAnotherTypeGetsNoGoal()
        {
            using Live live = Live.Connected();
            Reached(live, new List<FibonacciSequence>());
            foreach (IMessage goal in new IMessage[] { new EmptyRequest(), new DynamicMessage("nav2_msgs/action/NavigateToPose_Goal") })
            {
                GoalResult<FibonacciSequence> end = Send(live, goal, null);
                Assert.AreEqual(GoalStatus.Unknown, end.Status);
                StringAssert.Contains("type", end.Error);
            }
        }

        [Test]
        public void AGoalOfALostConnectionIsEnded()
        {
            using Live live = Live.Connected(Live.Rogue, "/through");
            Reached(live, new List<FibonacciSequence>());
            int heard = 0;
            GoalResult<FibonacciSequence>? end = null;
            live.Client.SendGoal<FibonacciSequence, FibonacciSequence>(
                Action, new FibonacciGoal { order = Endless }, feedback => heard++, result => end = result);
            live.Until(() => heard > 0, "for feedback");
            live.Client.Request("cut", null, null);
            live.Until(() => end.HasValue, "for the end");
            StringAssert.Contains("lost", end.Value.Error);
            Assert.AreEqual(0, live.Client.PendingRequests);
        }

        // The first that succeeds: the gateway may just have started, and not know the action yet.
        private static GoalResult<FibonacciSequence> Reached(Live live, List<FibonacciSequence> feedback)
        {
            GoalResult<FibonacciSequence> end = default(GoalResult<FibonacciSequence>);
            live.Until(() => end.Succeeded, "for a goal to be reached", () =>
            {
                end = Send(live, new FibonacciGoal { order = 5 }, feedback);
            });
            return end;
        }

        private static GoalResult<FibonacciSequence> Send(
            Live live, IMessage goal, List<FibonacciSequence> feedback)
        {
            GoalResult<FibonacciSequence>? end = null;
            live.Client.SendGoal<FibonacciSequence, FibonacciSequence>(
                Action, goal, feedback == null ? (System.Action<FibonacciSequence>)null : feedback.Add, result => end = result);
            live.Until(() => end.HasValue, "for the result");
            return end.Value;
        }

        private static int[] Start(int[] numbers, int count)
        {
            int[] start = new int[System.Math.Min(count, numbers.Length)];
            System.Array.Copy(numbers, start, start.Length);
            return start;
        }
    }
}
