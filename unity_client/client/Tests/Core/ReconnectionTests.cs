// SPDX-License-Identifier: Apache-2.0
using NUnit.Framework;
using Ros2Gateway.Messages.NavMsgs;
using Ros2Gateway.Messages.StdMsgs;
using Ros2Gateway.Messages.StdSrvs;

namespace Ros2Gateway.Tests
{
    /// <summary>A line to a live gateway is cut again and again. Topics are open again.</summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class ReconnectionTests
    {
        private const int Cuts = 5;

        [Test]
        public void EverythingThatWasOpenIsOpenAgain()
        {
            using Live live = Through();
            int odometries = 0;
            string text = "";
            RosGraph graph = null;
            live.Client.Subscribe<OdometryMsg>("/odom", message => odometries++);
            live.Client.Subscribe<StringMsg>("/said", message => text = message.data);
            Publisher<StringMsg> said = live.Client.Advertise<StringMsg>("/said");
            live.Client.AdvertiseService<TriggerRequest, TriggerResponse>(
                "/asked", TriggerRequest.Service, request => new TriggerResponse { success = true, message = "yes" });
            live.Client.WatchGraph(now => graph = now);

            for (int cut = 0; cut < Cuts; cut++)
            {
                int before = odometries;
                live.Until(() => odometries > before, "for odometry");
                string words = "after cut " + cut;
                live.Until(() => text == words, "for the text", () =>
                {
                    said.Publish(new StringMsg { data = words });
                    live.Client.Pump();
                });
                live.Until(() => Asked(live), "for the service");
                live.Until(() => graph != null && graph.TopicType("/said").Length > 0, "for the graph");
                graph = null;
                Cut(live);
            }
        }

        [Test]
        public void ALatchedMessageIsSentAgainAndAnotherIsNot()
        {
            using Live live = Through();
            Publisher<StringMsg> latched = live.Client.Advertise<StringMsg>(
                "/kept_by_latch", new AdvertiseOptions { Latch = true });
            Publisher<StringMsg> plain = live.Client.Advertise<StringMsg>("/not_kept");
            latched.Publish(new StringMsg { data = "a state" });
            plain.Publish(new StringMsg { data = "a command" });
            Cut(live);
            using Live other = Live.Connected();
            string state = null;
            string command = null;
            other.Client.Subscribe<StringMsg>("/kept_by_latch", message => state = message.data);
            other.Client.Subscribe<StringMsg>("/not_kept", message => command = message.data);
            other.Until(() => state == "a state", "for the latched message", () =>
            {
                live.Client.Pump();
                other.Client.Pump();
            });
            other.Until(() => command != null, "for a plain message", () =>
            {
                plain.Publish(new StringMsg { data = "another command" });
                live.Client.Pump();
                other.Client.Pump();
            });
            Assert.AreEqual("another command", command);
        }

        [Test]
        public void ACallThatWasUnderWayIsAnswered()
        {
            using (Live live = Through())
            using (Live provider = Live.Connected())
            {
                // It is provided, and never pumped: the call waits until the line is cut.
                provider.Client.AdvertiseService<TriggerRequest, TriggerResponse>(
                    "/never_answers", TriggerRequest.Service, request => new TriggerResponse());
                provider.Until(() => provider.Client.RosClock.IsKnown, "for the first pong");
                string error = null;
                live.Client.CallService<TriggerResponse>(
                    "/never_answers", new TriggerRequest(), reply => error = reply.Error ?? "answered", 60000);
                live.Client.Request("cut", null, null);
                live.Until(() => error != null, "for the answer");
                StringAssert.Contains("lost", error);
            }
        }

        [Test]
        public void ACallThatCameOnALostConnectionIsNotAnsweredOnTheNext()
        {
            using (Live provider = Through())
            using (Live caller = Live.Connected())
            {
                bool isHandled = false;
                provider.Client.AdvertiseService<TriggerRequest, TriggerResponse>(
                    "/slow_to_answer", TriggerRequest.Service, request =>
                    {
                        isHandled = true;
                        return new TriggerResponse();
                    });
                provider.Until(() => provider.Client.RosClock.IsKnown, "for the first pong");
                string error = null;
                long frames = provider.Client.FramesReceived;
                caller.Client.CallService<TriggerResponse>(
                    "/slow_to_answer", new TriggerRequest(), reply => error = reply.Error ?? "answered", 60000);
                // It is in the mailbox of the provider, who is not pumped.
                caller.Until(() => provider.Client.FramesReceived > frames, "for the call to arrive");
                provider.Client.Request("cut", null, null);
                caller.Until(() => error != null, "for the failure");
                // The gateway may notice first. Pumped before it notices too, the provider would rightly handle it.
                caller.Until(() => provider.Client.PendingRequests == 0, "for the provider to notice");
                provider.Until(() => provider.Heard("lost") && provider.Client.IsConnected, "to be connected again");
                Assert.IsFalse(isHandled);
            }
        }

        [Test]
        public void ConnectingAndDisconnectingInAnyOrderIsHarmless()
        {
            using Live live = new(Live.Gateway);
            live.Client.Disconnect();
            live.Client.Connect();
            live.Client.Connect();
            live.Client.Disconnect();
            live.Client.Disconnect();
            live.Client.Connect();
            live.Until(() => live.Client.IsConnected, "to be connected");
            live.Client.Disconnect();
            Assert.AreEqual(ConnectionState.Disconnected, live.Client.State);
            live.Client.Connect();
            live.Until(() => live.Client.IsConnected, "to be connected again");
            live.Client.Dispose();
            live.Client.Dispose();
            live.Client.Connect();
            Assert.AreEqual(ConnectionState.Disconnected, live.Client.State);
        }

        private static Live Through() =>
            Live.Connected(Live.Rogue, "/through", options => options.FirstPauseMilliseconds = 20);

        private static void Cut(Live live)
        {
            live.Until(() => live.Client.IsConnected, "to be connected");
            int before = live.Client.Connections;
            live.Client.Request("cut", null, null);
            live.Until(() => live.Client.Connections > before, "for another connection");
            live.Events.Clear();
            live.Until(() => live.Client.IsConnected, "to be connected again");
        }

        private static bool Asked(Live live)
        {
            bool? isYes = null;
            live.Client.CallService<TriggerResponse>(
                "/asked", new TriggerRequest(), reply => isYes = reply.Ok && reply.Value.message == "yes");
            live.Until(() => isYes.HasValue, "for the answer");
            return isYes.Value;
        }
    }
}
