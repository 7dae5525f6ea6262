// SPDX-License-Identifier: Apache-2.0
using System;
using System.Threading;
using NUnit.Framework;
using Ros2Gateway.Json;
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Messages.NavMsgs;

namespace Ros2Gateway.Tests
{
    /// <summary>Drivers, stops, and the words for a refused publisher, through a live gateway.</summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class RobotControlTests
    {
        private const string Topic = "/cmd_vel";
        private const string Speed = "{\"linear\":{\"x\":0.05}}";

        private static readonly TwistMsg Zero = new();

        [SetUp]
        public void SetUp()
        {
            // The latch outlives connections, and so does what another test has left behind.
            using (Live live = Live.Connected())
            using (RobotControl control = live.Client.Control(Topic))
            {
                Publisher<TwistMsg> commands = live.Client.Advertise<TwistMsg>(Topic);
                Reset(live, control, commands);
                Answered<ControlState>(live, control.Release);
            }
        }

        [Test]
        public void WhoDrivesIsKnownAndChangesAreTold()
        {
            ControlState told = null;
            using (Live live = Live.Connected())
            using (RobotControl control = live.Client.Control("cmd_vel", state => told = state))
            {
                Assert.AreEqual(Topic, control.Topic);
                Publisher<TwistMsg> commands = live.Client.Advertise<TwistMsg>(Topic);
                live.Until(() => told != null && told.IsKnown, "for the state");
                Assert.AreEqual(GuardState.Ready, told.Guard);
                Assert.AreEqual(0.5, told.DeadlineSeconds);
                Assert.AreEqual(2.0, told.LeaseSeconds);
                Drive(live, control, commands);
                live.Until(() => told.Motion == RobotMotion.Moving, "to be told");
                Assert.AreEqual(ControlHolder.You, told.Holder);
                Assert.AreEqual("you drive", told.ToString());
                Assert.IsTrue(commands.Publish(Zero));
                live.Until(() => told.Motion == RobotMotion.Stopped, "to be told that it stands");
                Assert.AreEqual("zero", told.Cause);
                Assert.IsFalse(told.IsTripped);
                live.Until(() => told.Holder == ControlHolder.None, "for the lease to end");
            }
        }

        [TestCase(TwistMsg.Type)]
        [TestCase(TwistStampedMsg.Type)]
        public void AnotherTopicIsNoCommandTopicAndPublishingThereIsAsEver(string type)
        {
            using (Live live = Live.Connected())
            using (RobotControl control = live.Client.Control("/wind"))
            {
                string topic = "/wind" + type.Length;
                Publisher wind = live.Client.Advertise(topic, type);
                DynamicMessage heard = null;
                live.Client.Subscribe(topic, type, () => new DynamicMessage(type), message => heard = message);
                live.Until(() => control.State.ToString().Contains("is not a command topic"), "for the answer");
                Assert.IsFalse(control.State.IsKnown);
                Assert.AreEqual(0, live.Events.FindAll(one => one.Level == EventLevel.Error).Count);
                JsonValue speed = JsonValue.Parse(Speed);
                DynamicMessage message1 = new(type)
                {
                    Value = type == TwistMsg.Type ? speed : JsonValue.Object().With("twist", speed),
                };
                live.Until(() => wind.Publish(message1) && heard != null, "for the wind");
            }
        }

        [Test]
        public void AfterAFreezePublishIsFalseUntilAZeroWasSent()
        {
            using (Live live = Live.Connected())
            using (RobotControl control = live.Client.Control(Topic))
            {
                Publisher<TwistMsg> commands = live.Client.Advertise<TwistMsg>(Topic);
                Drive(live, control, commands);
                // No command for longer than the deadline: the program freezes, its threads do not.
                Assert.IsTrue(SpinWait.SpinUntil(() => control.State.IsTripped, 60000), "nothing stopped the robot");
                Assert.AreEqual("deadline", control.State.Cause);
                long published = commands.Published;
                Assert.IsFalse(commands.Publish(Ahead()));
                Assert.IsFalse(commands.Publish(Ahead()));
                Assert.AreEqual(published, commands.Published);
                StringAssert.Contains("stopped, commands stopped arriving: let go", commands.Refusal);
                live.Until(() => live.Heard("/cmd_vel: stopped, commands stopped arriving"), "for the reason");
                Assert.IsTrue(commands.Publish(Zero));
                live.Until(() => commands.Refusal == null, "for the reset");
                Drive(live, control, commands);
                Assert.IsTrue(commands.Publish(Zero));
            }
        }

        [Test]
        public void OfTwoClientsTheSecondIsRefusedUntilItTakesControl()
        {
            using (Live first = Live.Connected())
            using (Live second = Live.Connected())
            using (RobotControl control = first.Client.Control(Topic))
            using (RobotControl other = second.Client.Control(Topic))
            {
                Publisher<TwistMsg> commands = first.Client.Advertise<TwistMsg>(Topic);
                Publisher<TwistMsg> others = second.Client.Advertise<TwistMsg>(Topic);
                Drive(first, control, commands);
                Action both = () =>
                {
                    Push(first, control, commands);
                    second.Client.Pump();
                };
                second.Until(() => !others.Publish(Ahead()) && others.Refusal != null, "to be refused", both);
                StringAssert.Contains("another client drives", others.Refusal);
                Assert.AreEqual(ControlHolder.Other, other.State.Holder);

                Reply<ControlState>? reply = null;
                other.Acquire(answer => reply = answer);
                second.Until(() => reply.HasValue, "for control", both);
                Assert.AreEqual(ControlHolder.You, reply.Value.OrThrow().Holder);
                first.Until(() => !commands.Publish(Ahead()), "to be refused in turn", both);
                Reset(second, other, others);
                first.Until(() => commands.Refusal == "another client drives", "for the reason", () =>
                {
                    Push(second, other, others);
                    both();
                });
                Assert.AreEqual(RobotMotion.Moving, other.State.Motion);
                bool isReleased = false;
                other.Release(answer => isReleased = answer.Ok);
                second.Until(() => isReleased, "for an answer");
                Assert.AreEqual(ControlHolder.None, other.State.Holder);
                Reset(first, control, commands);
                Drive(first, control, commands);
                Assert.IsTrue(commands.Publish(Zero));
            }
        }

        [TestCase(false)]
        [TestCase(true)]
        public void AThirdStopsTheRobotAndTheDriverHasToLetGo(bool all)
        {
            using (Live live = Live.Connected())
            using (Live third = Live.Connected())
            using (RobotControl control = live.Client.Control(Topic))
            using (RobotControl stop = third.Client.Control(Topic))
            {
                Publisher<TwistMsg> commands = live.Client.Advertise<TwistMsg>(Topic);
                OdometryMsg odometry = null;
                third.Client.Subscribe<OdometryMsg>("/odom", message => odometry = message);
                Drive(live, control, commands);
                Reply<string[]>? reply = null;
                Action<Reply<string[]>> done = answer => reply = answer;
                if (all)
                {
                    third.Client.StopRobots(done);
                }
                else
                {
                    stop.Stop(done);
                }
                third.Until(() => reply.HasValue, "for an answer");
                CollectionAssert.AreEqual(new[] { Topic }, reply.Value.OrThrow());
                // the cause alone may be another test's
                live.Until(() => control.State.IsTripped && control.State.Cause == "stop", "to be told");
                Assert.IsFalse(commands.Publish(Ahead()));
                third.Until(
                    () => odometry != null && Math.Abs(odometry.twist.twist.linear.x) < 1e-3, "for the robot to stand");
                Reset(live, control, commands);
                Drive(live, control, commands);
                // A driver may stop without a trip.
                Answered<string[]>(live, control.Stop);
                Assert.IsFalse(control.State.IsTripped);
                live.Until(() => commands.Publish(Ahead()), "to drive without a zero"); // a busy machine may hold a ping up
                commands.Publish(Zero);
            }
        }

        [Test]
        public void AValueThatIsNotFiniteStopsTheRobotAndTheNextIsRefused()
        {
            using (Live live = Live.Connected())
            using (RobotControl control = live.Client.Control(Topic))
            {
                Publisher<TwistMsg> commands = live.Client.Advertise<TwistMsg>(Topic);
                TwistMsg wrong = Ahead();
                wrong.angular.z = double.NaN;
                live.Until(() => control.State.IsTripped && control.State.Cause == "invalid_value", "to be told", () =>
                {
                    Drive(live, control, commands);
                    commands.Publish(wrong); // true, or the gateway could not stop the robot
                    live.Until(() => commands.Refusal != null, "to be refused");
                    Assert.IsFalse(commands.Publish(wrong));
                    live.Until(() => control.State.IsTripped, "to be stopped");
                });
                live.Until(() => live.Heard("expected a finite number"), "for the reason");
                Reset(live, control, commands);
                // Of a robot that stands, it is the message alone that is refused, and for a moment.
                Assert.IsTrue(commands.Publish(wrong));
                live.Until(() => commands.Refusal != null && commands.Refusal.Contains("finite"), "to be refused again");
                live.Until(() => commands.Refusal == null, "for the moment to end");
                Assert.IsFalse(control.State.IsTripped);
            }
        }

        [Test]
        public void ACommandThatIsTooFastIsSlowedDownAndTold()
        {
            using (Live live = Live.Connected())
            using (RobotControl control = live.Client.Control(Topic))
            {
                Publisher<TwistMsg> commands = live.Client.Advertise<TwistMsg>(Topic);
                TwistMsg fast = new();
                fast.angular.z = 1000;
                live.Until(
                    () => live.Heard("a command was too fast") && control.State.Motion == RobotMotion.Moving,
                    "for the warning", () => Push(live, control, commands, fast));
                Assert.IsFalse(live.Events.Exists(one => one.Level == EventLevel.Error && one.Text.Contains("fast")));
                live.Until(() => commands.Publish(Zero), "to stop"); // a busy machine may hold a ping up
            }
        }

        [Test]
        public void ALateCommandIsRefused()
        {
            using (Live live = Live.Connected(Live.Rogue, "/through"))
            using (RobotControl control = live.Client.Control(Topic))
            {
                Publisher<TwistMsg> commands = live.Client.Advertise<TwistMsg>(Topic);
                // for as long as the gateway takes to learn how fast commands travel
                DateTime end = DateTime.UtcNow.AddSeconds(1.2);
                // and to a robot that moves: what was refused last, of a busy machine, would refuse the next one as well
                live.Until(
                    () => DateTime.UtcNow > end && control.State.Motion == RobotMotion.Moving && commands.Refusal == null,
                    "for a while", () => Push(live, control, commands));
                commands.Publish(Zero);
                live.Client.Request("stall", null, null);
                Assert.IsTrue(commands.Publish(Ahead()), "it is on its way, and waits there");
                live.Until(() => live.Heard("by its monotonic_ms"), "for the refusal");
                Assert.AreEqual(RobotMotion.Stopped, control.State.Motion);
            }
        }

        [Test]
        public void AfterALossControlIsTakenBackAndTheRobotMovesOnlyAfterAZero()
        {
            using (Live observer = Live.Connected())
            using (Live live = Live.Connected(Live.Rogue, "/through", options => options.FirstPauseMilliseconds = 20))
            using (RobotControl control = live.Client.Control(Topic))
            {
                OdometryMsg odometry = null;
                observer.Client.Subscribe<OdometryMsg>("/odom", message => odometry = message);
                Publisher<TwistMsg> commands = live.Client.Advertise<TwistMsg>(Topic);
                live.Until(() => control.State.IsKnown, "for the state");
                Answered<ControlState>(live, control.Acquire);
                for (int cut = 0; cut < 3; cut++)
                {
                    Drive(live, control, commands);
                    int states = live.States.Count;
                    live.Client.Request("cut", null, null);
                    live.Until(() => live.States.Count > states, "for the cut");
                    // on a busy machine it has connected again in the meantime, and the gateway refuses what is published
                    Assert.IsTrue(control.State.ToString() == "not connected" || live.States.Count > states + 1);
                    bool isOnItsWay = commands.Publish(Ahead());
                    Assert.IsTrue(!isOnItsWay || live.Client.IsConnected);
                    live.Until(() => control.State.Holder == ControlHolder.You, "to have control again", () =>
                    {
                        live.Client.Pump();
                        commands.Publish(Ahead());
                    });
                    Assert.IsTrue(control.State.IsTripped);
                    Assert.AreEqual("disconnect", control.State.Cause);
                    Assert.IsFalse(commands.Publish(Ahead()));
                    odometry = null;
                    observer.Until(() => odometry != null, "for odometry");
                    Reset(live, control, commands);
                }
                Answered<ControlState>(live, control.Release);
                Assert.AreEqual(ControlHolder.None, control.State.Holder);
            }
        }

        [TestCase(TwistMsg.Type)]
        [TestCase(TwistStampedMsg.Type)]
        public void WithoutAGuardNothingButZerosGoes(string type)
        {
            using (Live live = Live.Connected(Live.Rogue, "/refuses-commands"))
            using (RobotControl control = live.Client.Control("/unguarded"))
            {
                Publisher commands = live.Client.Advertise("/unguarded", type);
                live.Until(() => control.State.Guard == GuardState.Lost, "for the state");
                StringAssert.Contains("the guard process of the gateway is not running", commands.Refusal);
                TwistStampedMsg ahead = new() { twist = Ahead() };
                TwistStampedMsg zero = new();
                zero.header.stamp.sec = 7;
                bool isPlain = type == TwistMsg.Type;
                JsonValue speed = JsonValue.Parse(Speed);
                DynamicMessage tree = new(type)
                {
                    Value = isPlain ? speed : JsonValue.Object().With("twist", speed),
                };
                Assert.IsFalse(isPlain ? commands.Publish(ahead.twist) : commands.Publish(ahead));
                Assert.IsFalse(commands.Publish(tree));
                Assert.IsTrue(isPlain ? commands.Publish(zero.twist) : commands.Publish(zero));
                Assert.IsTrue(commands.Publish(new DynamicMessage(type)));
            }
        }

        [Test]
        public void WhoAsksLateIsToldWhatIsKnown()
        {
            using (Live live = Live.Connected(Live.Rogue, "/refuses-commands"))
            using (RobotControl first = live.Client.Control("/unguarded"))
            {
                live.Until(() => first.State.IsKnown, "for the state");
                live.Client.Pump();
                ControlState late = null;
                live.Client.Control("/unguarded", state => late = state);
                live.Until(() => late != null, "to be told");
                Assert.AreEqual(GuardState.Lost, late.Guard);
            }
        }

        [Test]
        public void APublisherThatMayNotPublishAsksAgainFromTimeToTime()
        {
            using Live live = Live.Connected(Live.Rogue, "/refuses-commands");
            using RobotControl control = live.Client.Control("/forbidden");
            Publisher<TwistMsg> publisher = live.Client.Advertise<TwistMsg>("/forbidden");
            TwistMsg ahead = Ahead();
            for (int i = 0; i < 3; i++)
            {
                live.Until(() => publisher.Publish(ahead), "to ask");
                live.Until(() => !publisher.Publish(ahead), "to be refused");
                Assert.AreEqual("you may not publish on /forbidden", publisher.Refusal);
            }
            live.Until(() => live.Heard("you may not publish on /forbidden"), "for the reason");
        }

        [Test]
        public void WhatADriverMayKnowIsForgottenWithTheLastWhoAsks()
        {
            using Live live = Live.Connected();
            int told = 0;
            RobotControl control = live.Client.Control(Topic, state => told++);
            RobotControl second = live.Client.Control(Topic);
            live.Until(() => told > 0 && second.State.IsKnown, "for the state");
            control.Dispose();
            control.Dispose();
            Answered<string[]>(live, second.Stop); // the entities of both were answered before
            Assert.AreEqual(0, live.Events.FindAll(one => one.Level == EventLevel.Error).Count);
            int before = told;
            Publisher<TwistMsg> commands = live.Client.Advertise<TwistMsg>(Topic);
            Drive(live, second, commands);
            Assert.AreEqual(before, told);
            commands.Publish(Zero);
            commands.Dispose();
            second.Dispose();
        }

        [Test]
        public void PublishingCommandsAllocatesNothingWhetherTheyGoOrNot()
        {
            long start = GC.GetAllocatedBytesForCurrentThread();
            GC.KeepAlive(new byte[1000]);
            if (GC.GetAllocatedBytesForCurrentThread() - start < 1000)
            {
                Assert.Ignore("this runtime does not count what a thread allocates");
            }
            using (Live live = Live.Connected())
            using (RobotControl control = live.Client.Control(Topic))
            {
                Publisher<TwistMsg> commands = live.Client.Advertise<TwistMsg>(Topic);
                Drive(live, control, commands);
                live.Until(() => control.State.IsTripped, "to be stopped");
                TwistMsg ahead = Ahead();
                Assert.IsFalse(commands.Publish(ahead)); // it is told, once
                long before = GC.GetAllocatedBytesForCurrentThread();
                for (int i = 0; i < 1000; i++)
                {
                    commands.Publish(ahead);
                }
                Assert.AreEqual(0, GC.GetAllocatedBytesForCurrentThread() - before);
                Reset(live, control, commands);
            }
        }

        private static TwistMsg Ahead()
        {
            TwistMsg twist = new();
            twist.linear.x = 0.05;
            return twist;
        }

        private static void Push(
            Live live, RobotControl control, Publisher<TwistMsg> commands, TwistMsg command = null)
        {
            // a machine that is busy with other things may hold up a command for longer than the deadline
            commands.Publish(control.State.IsTripped ? Zero : command ?? Ahead());
            live.Client.Pump();
            Thread.Sleep(20);
        }

        /// <summary>Publishes until the gateway says that the robot is moved.</summary>
        private static void Drive(Live live, RobotControl control, Publisher<TwistMsg> commands)
        {
            // of two commands at least, or the gateway takes it for one that was typed by hand
            long enough = commands.Published + 5;
            live.Until(
                () => control.State.Motion == RobotMotion.Moving && commands.Published > enough,
                "to drive", () => Push(live, control, commands));
        }

        /// <summary>Zeros until a robot that was stopped may be driven.</summary>
        private static void Reset(Live live, RobotControl control, Publisher<TwistMsg> commands) => live.Until(
            () => control.State.IsKnown && !control.State.IsTripped && commands.Refusal == null
                && control.State.Holder == ControlHolder.You,
            "for a reset", () =>
        {
            commands.Publish(Zero);
            live.Client.Pump();
            Thread.Sleep(20);
        });

        private static void Answered<T>(Live live, Action<Action<Reply<T>>> request)
        {
            Reply<T>? reply = null;
            request(answer => reply = answer);
            live.Until(() => reply.HasValue, "for an answer");
            reply.Value.OrThrow();
        }
    }
}
