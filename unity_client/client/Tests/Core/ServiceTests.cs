// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;
using System.Threading.Tasks;
using NUnit.Framework;
using Ros2Gateway.Json;
using Ros2Gateway.Messages.StdMsgs;
using Ros2Gateway.Messages.StdSrvs;

namespace Ros2Gateway.Tests
{
    /// <summary>Services, parameters and the graph, through a live gateway.</summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class ServiceTests
    {
        [Test]
        public void AServiceOfTheRobotAnswers()
        {
            using Live live = Live.Connected();
            Reply<SetBoolResponse> reply = Call<SetBoolResponse>(live, "motor_power", new SetBoolRequest { data = true });
            Assert.IsTrue(reply.Ok, reply.Error);
            Assert.IsTrue(reply.Value.success);
        }

        [Test]
        public void AServiceThatDoesNotExistIsAnsweredInTheGatewaysWords()
        {
            using Live live = Live.Connected();
            live.Until(() => Call<SetBoolResponse>(live, "/motor_power", new SetBoolRequest { data = true }).Ok, "for the robot");
            Reply<SetBoolResponse> reply = Call<SetBoolResponse>(live, "/motor_powr", new SetBoolRequest());
            Assert.IsFalse(reply.Ok);
            Assert.AreEqual("service /motor_powr does not exist; did you mean /motor_power?", reply.Error);
            live.Until(() => live.Heard("did you mean /motor_power?"), "for the event");
            Assert.Throws<GatewayException>(() => reply.OrThrow());
        }

        [Test]
        public void AServiceOfAnotherTypeIsNotCalled()
        {
            using Live live = Live.Connected();
            live.Until(() => Call<SetBoolResponse>(live, "/motor_power", new SetBoolRequest { data = true }).Ok, "for the robot");
            Reply<TriggerResponse> reply = Call<TriggerResponse>(live, "/motor_power", new TriggerRequest());
            Assert.IsFalse(reply.Ok);
            StringAssert.StartsWith(
                "service /motor_power has type std_srvs/srv/SetBool, not std_srvs/srv/Trigger", reply.Error);
            JsonValue on = JsonValue.Object().With("data", true);
            foreach (string type in new[] { "", "std_srvs/SetBool", "std_srvs/srv/SetBool_Request" })
            {
                reply = Call<TriggerResponse>(live, "/motor_power", new DynamicMessage(type) { Value = on });
                Assert.IsTrue(reply.Ok, reply.Error);
            }
        }

        [Test]
        public void AnswersToManyCallsFindTheirCallers()
        {
            using Live live = Live.Connected();
            Provide(live, "/invert");
            HashSet<int> right = new();
            for (int i = 0; i < 100; i++)
            {
                int number = i;
                live.Client.CallService<SetBoolResponse>(
                    "/invert", new SetBoolRequest { data = number % 3 == 0 }, reply =>
                    {
                        if (reply.Ok && reply.Value.success != (number % 3 == 0))
                        {
                            right.Add(number);
                        }
                    });
            }
            live.Until(() => right.Count == 100, "for all answers");
            Assert.AreEqual(0, live.Client.PendingRequests);
        }

        [Test]
        public void AHandlerThatThrowsFailsTheCallOfItsCaller()
        {
            using Live live = Live.Connected();
            live.Client.AdvertiseService<TriggerRequest, TriggerResponse>(
                "/throws", TriggerRequest.Service, request => { throw new System.InvalidOperationException("no such luck"); });
            Reply<TriggerResponse> reply = Reply<TriggerResponse>.Failed("");
            live.Until(() => reply.Ok, "for the call to come through", () => reply = Call<TriggerResponse>(live, "/throws", new TriggerRequest()));
            Assert.IsFalse(reply.Value.success);
            StringAssert.Contains("no such luck", reply.Value.message);
        }

        [Test]
        public void ARequestLargerThanTheGatewayTakesIsRefusedHereAndTheConnectionStays()
        {
            using Live live = Live.Connected();
            live.Until(() => live.Client.RosClock.IsKnown, "for the first pong, which comes after hello");
            JsonValue members = JsonValue.Object().With("service", "/reset").With("args", new string('x', 11000000));
            string error = null;
            live.Client.Request("call_service", members, reply => error = reply.Error);
            live.Until(() => error != null, "for the refusal");
            StringAssert.StartsWith("a frame of 110", error);
            Assert.IsTrue(live.Client.IsConnected);
        }

        [Test]
        public void AClassThatThrowsWhileItReadsFailsTheCallAndNothingElse()
        {
            using Live live = Live.Connected();
            live.Client.AdvertiseService<Throwing, TriggerResponse>(
                "/reads_badly", TriggerRequest.Service, request => new TriggerResponse { success = true });
            live.Until(() => Call<TriggerResponse>(live, "/motor_power", new SetBoolRequest()).Ok, "for the robot");
            Reply<Throwing> response = Call<Throwing>(live, "/motor_power", new SetBoolRequest());
            StringAssert.Contains("answer cannot be read: not today", response.Error);
            Reply<TriggerResponse> answer = Reply<TriggerResponse>.Failed("");
            live.Until(() => answer.Ok, "for the service", () =>
            {
                answer = Call<TriggerResponse>(live, "/reads_badly", new TriggerRequest());
            });
            // More than may wait at once: none of those that failed waits any more.
            for (int i = 0; i < 100; i++)
            {
                answer = Call<TriggerResponse>(live, "/reads_badly", new TriggerRequest());
                StringAssert.Contains("not today", answer.Value.message);
            }
        }

        [Test]
        public void CallsWithoutAConnectionAreAnsweredAtOnce()
        {
            using GatewayClient client = new(new GatewayOptions());
            string error = null;
            client.CallService<TriggerResponse>("/reset", new TriggerRequest(), reply => error = reply.Error);
            client.Pump();
            Assert.AreEqual("not connected", error);
        }

        [Test]
        public void ParametersAreListedReadSetAndDescribed()
        {
            using Live live = Live.Connected();
            string node = "/ros2_gateway_debug";
            string[] names = Answer(live, live.Client.ListParametersAsync(node));
            CollectionAssert.Contains(names, "use_sim_time");
            JsonValue got = Answer(live, live.Client.GetParametersAsync(node, new[] { "use_sim_time" }));
            Assert.AreEqual(JsonKind.Boolean, got["use_sim_time"].Kind);
            JsonValue set = Answer(
                live, live.Client.SetParametersAsync(node, JsonValue.Object().With("use_sim_time", "yes")));
            Assert.IsFalse(set["use_sim_time"]["successful"].AsBool(true));
            JsonValue described = Answer(live, live.Client.DescribeParametersAsync(node));
            Assert.AreEqual("bool", described["use_sim_time"]["type"].AsString());
        }

        private static T Answer<T>(Live live, Task<T> task)
        {
            live.Until(() => task.IsCompleted, "for an answer");
            return task.Result;
        }

        [Test]
        public void TheGraphIsToldAndItsChangesToo()
        {
            using Live live = Live.Connected();
            RosGraph graph = null;
            live.Client.WatchGraph(now => graph = now);
            live.Until(() => graph != null && graph.TopicType("/odom") == "nav_msgs/msg/Odometry", "for /odom");
            Publisher publisher = live.Client.Advertise<StringMsg>("/appears");
            live.Until(() => graph.TopicType("appears") == "std_msgs/msg/String", "for the new topic");
            publisher.Dispose();
            live.Until(() => graph.TopicType("/appears").Length == 0, "for the topic to go");
            CollectionAssert.Contains(new List<string>(graph.Nodes), "/simulated_robot");
            CollectionAssert.Contains(new List<string>(graph.Services), "/motor_power");
        }

        [Test]
        public void TheClockOfRosIsLearntFromPings()
        {
            using Live live = Live.Connected();
            live.Until(() => live.Client.RosClock.IsKnown, "for the first pong");
            double now = (System.DateTime.UtcNow - new System.DateTime(1970, 1, 1)).TotalSeconds;
            Assert.AreEqual(now, live.Client.RosClock.RosSeconds, 1 + live.Client.RosClock.ErrorSeconds);
        }

        private sealed class Throwing : IMessage
        {
            public string RosType => "std_srvs/srv/Trigger_Request";

            public void Read(JsonReader reader) => throw new System.NotSupportedException("not today");

            public void Write(JsonWriter writer)
            {
            }
        }

        private static void Provide(Live live, string service)
        {
            live.Client.AdvertiseService<SetBoolRequest, SetBoolResponse>(
                service, SetBoolRequest.Service, request => new SetBoolResponse { success = !request.data });
            live.Until(() => Call<SetBoolResponse>(live, service, new SetBoolRequest()).Ok, "for the service to be found");
        }

        private static Reply<T> Call<T>(Live live, string service, IMessage request)
            where T : IMessage, new()
        {
            bool isAnswered = false;
            Reply<T> answer = default(Reply<T>);
            live.Client.CallService<T>(service, request, reply =>
            {
                answer = reply;
                isAnswered = true;
            });
            live.Until(() => isAnswered, "for the answer of " + service);
            return answer;
        }
    }
}
