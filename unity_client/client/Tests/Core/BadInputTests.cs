// SPDX-License-Identifier: Apache-2.0
using NUnit.Framework;
using Ros2Gateway.Messages.NavMsgs;
using Ros2Gateway.Messages.StdMsgs;

namespace Ros2Gateway.Tests
{
    /// <summary>Any bad input is an event: no exception, no dead reader.</summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class BadInputTests
    {
        [Test]
        public void BadFramesBecomeEventsAndTheNextGoodOneIsRead()
        {
            using Live live = new(Live.Rogue, "/bad-frames");
            OdometryMsg good = null;
            Subscription<OdometryMsg> odom = live.Client.Subscribe<OdometryMsg>(
                "/odom", message => good = message.child_frame_id == "the good one" ? message : good,
                new SubscribeOptions { Queue = 100 });
            live.Client.Connect();
            live.Until(() => good != null, "for the good message");

            Assert.IsTrue(live.Client.IsConnected);
            Assert.IsTrue(live.Heard("words of the gateway"));
            Assert.IsTrue(live.Heard("unknown op 'nonsense'"));
            Assert.IsTrue(live.Heard("op is missing"));
            Assert.IsTrue(live.Heard("/odom: a message cannot be read as nav_msgs/msg/Odometry"));
            Assert.GreaterOrEqual(odom.Unreadable, 7);
            Assert.IsFalse(live.Events.Exists(one => one.Code == "internal"), "an exception went astray");
        }

        [Test]
        public void AMessageBeyondTheLimitIsThrownAwayAndTold()
        {
            using Live live = new(Live.Rogue, "/huge");
            OdometryMsg good = null;
            live.Client.Subscribe<OdometryMsg>("/odom", message => good = message);
            live.Client.Connect();
            live.Until(() => good != null, "for the message after the huge one");
            Assert.IsTrue(live.Heard("a message of 200000"), "nobody was told of the huge one");
        }

        [TestCase("/bad-text")] // that is not UTF-8, which ends a connection (RFC 6455, 8.1)
        [TestCase("/dies")] // within a frame
        public void AConnectionThatEndsBadlyIsLostAndTriedAgain(string path)
        {
            using Live live = new(Live.Rogue, path, options => options.FirstPauseMilliseconds = 50);
            live.Client.Subscribe<OdometryMsg>("/odom", message => Assert.Fail("there was no message"));
            live.Client.Connect();
            live.Until(() => live.Heard("lost"), "for the end of the connection");
            int states = live.States.Count;
            live.Until(() => live.States.Count > states + 3, "for more attempts");
        }

        [Test]
        public void AMuteGatewayIsNoticedByItsSilence()
        {
            using Live live = Live.Connected(
                Live.Rogue, "/mute", options =>
                {
                    options.HeartbeatMilliseconds = 100;
                    options.SilenceMilliseconds = 400;
                });
            live.Until(() => live.Heard("no word from the gateway for 400 ms"), "for the silence to be noticed");
        }

        [Test]
        public void AMessageThatTakesLongerThanTheSilenceIsNoSilence()
        {
            using Live live = new(Live.Rogue, "/slow", options =>
            {
                options.HeartbeatMilliseconds = 100;
                options.SilenceMilliseconds = 1000;
            });
            OdometryMsg good = null;
            live.Client.Subscribe<OdometryMsg>("/odom", message => good = message);
            live.Client.Connect();
            live.Until(() => good != null, "for the slow message");
            Assert.IsFalse(live.Heard("lost"));
        }

        [Test]
        public void AServerThatNeverAnswersTheHandshakeIsGivenUp()
        {
            using Live live = new(Live.Deaf, "", options => options.ConnectMilliseconds = 300);
            live.Client.Connect();
            live.Until(() => live.Heard("no answer within 300 ms"), "for the attempt to be given up");
            Assert.IsFalse(live.Client.IsConnected);
        }

        [Test]
        public void ARefusedTokenIsToldAndNotTriedAgain()
        {
            using Live live = new(Live.Rogue, "/refuses");
            live.Client.Connect();
            live.Until(() => live.Client.State == ConnectionState.Refused, "to be refused");
            live.Until(() => live.Heard("the token is wrong (4401)"), "for the reason");
        }

        [Test]
        public void AGatewayThatIsFullIsTriedAgain()
        {
            using Live live = new(Live.Rogue, "/full");
            live.Client.Connect();
            live.Until(() => live.Heard("at most 32 clients") && live.Heard("trying again"), "for the reason");
            Assert.AreNotEqual(ConnectionState.Refused, live.Client.State);
        }

        [TestCase("")]
        [TestCase("localhost:9090")]
        [TestCase("http://localhost:9090")]
        [TestCase("ws://")]
        public void AnAddressThatIsNoneIsRefusedInWords(string address)
        {
            GatewayOptions options = new() { Address = address };
            using GatewayClient client = new(options);
            string heard = "";
            client.EventHeard += happened => heard = happened.Text;
            client.Connect();
            client.Pump();
            StringAssert.Contains("expected ws://HOST:PORT", heard);
            Assert.AreEqual(ConnectionState.Refused, client.State);
        }

        [Test]
        public void AHandlerThatThrowsHarmsNoOther()
        {
            using Live live = Live.Connected();
            int seen = 0;
            live.Client.Subscribe<OdometryMsg>("/odom", message => { throw new System.InvalidOperationException("oops"); });
            live.Client.Subscribe<OdometryMsg>("/odom", message => seen++);
            live.Until(() => seen > 3 && live.Heard("handler of /odom threw InvalidOperationException: oops"), "for both");
        }

        [Test]
        public void PublishingWithoutAConnectionFailsAndKeepsNothing()
        {
            using Live live = new(Live.Gateway);
            Publisher<StringMsg> publisher = live.Client.Advertise<StringMsg>("/kept");
            string got = null;
            live.Client.Subscribe<StringMsg>("/kept", message => got = message.data);
            Assert.IsFalse(publisher.Publish(new StringMsg { data = "too early" }));
            live.Client.Connect();
            live.Until(() => live.Client.IsConnected, "to be connected");
            live.Until(() => got != null, "for a message", () =>
            {
                publisher.Publish(new StringMsg { data = "in time" });
                live.Client.Pump();
            });
            Assert.AreEqual("in time", got);
        }
    }
}
