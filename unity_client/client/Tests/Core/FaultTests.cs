// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using NUnit.Framework;
using Ros2Gateway.Messages.StdMsgs;
using Ros2Gateway.Messages.StdSrvs;

namespace Ros2Gateway.Tests
{
    /// <summary>Handlers of the application's that throw, over a network that a test holds.</summary>
    [TestFixture]
    public sealed class FaultTests
    {
        private readonly List<string> _events = new();
        private StuckTransport _network;
        private GatewayClient _client;

        [SetUp]
        public void SetUp()
        {
            _events.Clear();
            _network = new StuckTransport();
            _client = new GatewayClient(new GatewayOptions { Transport = options => _network, UsesThreads = false });
            _client.EventHeard += happened => _events.Add(happened.Text);
            _client.Connect();
        }

        [TearDown]
        public void TearDown() => _client.Dispose();

        [Test]
        public void APrepareThatThrowsKeepsNoMessageFromTheHandler()
        {
            List<long> got = new();
            Subscription<Int64Msg> subscription = _client.Subscribe(
                "/numbers", Int64Msg.Type, () => new Int64Msg(), message => got.Add(message.data),
                prepare: message => Throw());
            for (int i = 1; i <= 12; i++)
            {
                _network.Receive("{\"op\":\"publish\",\"topic\":\"/numbers\",\"msg\":{\"data\":" + i + "}}");
                _client.Pump();
            }
            Assert.AreEqual("1 2 3 4 5 6 7 8 9 10 11 12", string.Join(" ", got));
            Assert.AreEqual(12, subscription.Received);
            Assert.AreEqual(0, subscription.Unreadable);
            IsToldTwice("prepare of /numbers");
        }

        [Test]
        public void AHandlerOfAnswersThatThrowsIsToldByNameWithACount()
        {
            bool isAnswered = false;
            for (int i = 1; i <= 12; i++)
            {
                _client.CallService<TriggerResponse>("/reset", new TriggerRequest(), reply => Throw());
                _client.CallService<TriggerResponse>("/else", new TriggerRequest(), reply => isAnswered = reply.Ok);
                Answer(2 * i - 1);
                Answer(2 * i);
                _client.Pump();
                Assert.IsTrue(isAnswered);
                isAnswered = false;
            }
            IsToldTwice("handler of call_service /reset");
        }

        [Test]
        public void AHandlerOfAGoalThatThrowsIsToldByNameWithACount()
        {
            for (int i = 1; i <= 12; i++)
            {
                Goal goal = _client.SendGoal<Int64Msg, Int64Msg>(
                    "/count", new Int64Msg(), feedback => Throw(), result => Throw());
                _network.Receive("{\"op\":\"action_feedback\",\"action\":\"/count\",\"id\":\"g" + i + "\",\"values\":{\"data\":1}}");
                _network.Receive("{\"op\":\"action_result\",\"action\":\"/count\",\"id\":\"g" + i
                    + "\",\"values\":{\"data\":2},\"status\":4,\"result\":true}");
                _client.Pump();
                Assert.AreEqual(GoalStatus.Succeeded, goal.Status);
            }
            IsToldTwice("handler of the feedback of /count");
            IsToldTwice("handler of the result of /count");
        }

        [Test]
        public void AServiceThatThrowsIsToldByNameWithACountAndAnswersItsCaller()
        {
            _client.AdvertiseService<TriggerRequest, TriggerResponse>(
                "/bell", TriggerRequest.Service, request => { throw new InvalidOperationException("not mine"); });
            for (int i = 1; i <= 12; i++)
            {
                _network.Receive("{\"op\":\"call_service\",\"service\":\"/bell\",\"id\":\"c" + i + "\",\"args\":{}}");
                _client.Pump();
                StringAssert.Contains("\"not mine\",\"result\":false", _network.Sent[_network.Sent.Count - 1]);
            }
            IsToldTwice("handler of service /bell");
        }

        [Test]
        public void ANullIsNamedWhereAMessageIsExpected()
        {
            string call = null;
            string goal = null;
            _client.CallService<TriggerResponse>("/reset", null, reply => call = reply.Error);
            _client.SendGoal<Int64Msg, Int64Msg>("/count", null, null, result => goal = result.Error);
            _client.AdvertiseService<TriggerRequest, TriggerResponse>("/bell", TriggerRequest.Service, request => null);
            _network.Receive("{\"op\":\"call_service\",\"service\":\"/bell\",\"id\":\"c\",\"args\":{}}");
            _client.Pump();
            Assert.AreEqual("the request is null: pass a message", call);
            Assert.AreEqual("the goal is null: pass a message", goal);
            StringAssert.Contains("the handler of /bell returned null: return a response", _network.Sent[_network.Sent.Count - 1]);
        }

        private void Answer(int request) =>
            _network.Receive("{\"op\":\"service_response\",\"id\":\"r" + request
                + "\",\"values\":{\"success\":true,\"message\":\"\"},\"result\":true}");

        private static void Throw() => throw new InvalidOperationException("not mine");

        /// <summary>Of 12 times the first and the 10th are told.</summary>
        private void IsToldTwice(string where)
        {
            _client.Pump();
            CollectionAssert.AreEqual(
                new[]
                {
                    where + " threw InvalidOperationException: not mine",
                    where + " threw InvalidOperationException, 10 times by now: not mine",
                },
                _events.FindAll(text => text.StartsWith(where)));
        }
    }
}
