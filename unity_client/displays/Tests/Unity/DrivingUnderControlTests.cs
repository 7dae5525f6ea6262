// SPDX-License-Identifier: Apache-2.0
using System.Collections;
using System.Collections.Generic;
using NUnit.Framework;
using Ros2Gateway.Drive;
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Messages.NavMsgs;
using UnityEngine;
using UnityEngine.TestTools;

namespace Ros2Gateway.Unity.Tests
{
    /// <summary>Drivers of the simulated robot, whom the gateway stops, refuses, and lets drive again.</summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class DrivingUnderControlTests
    {
        private const string Topic = "/cmd_vel";
        private const float Speed = 0.1f;
        private const int AFewFrames = 60;
        private const int PressedAnewFrames = 300;

        private DrivingScene _scene;
        private HeldKeys _keys;
        private RobotControl _control; // of the observer
        private Publisher<TwistMsg> _others; // the observer's
        private List<string> _faults;

        [SetUp]
        public void SetUp()
        {
            LogAssert.ignoreFailingMessages = true; // refusals are errors, and are meant
            _keys = new HeldKeys();
            _scene = new DrivingScene(Topic);
            _control = _scene.Observer.Control(Topic);
            _others = _scene.Observer.Advertise<TwistMsg>(Topic);
            _faults = new List<string>();
            Application.logMessageReceived += Hear;
        }

        [TearDown]
        public void TearDown()
        {
            Application.logMessageReceived -= Hear;
            _scene.Dispose();
        }

        [UnityTest]
        public IEnumerator WhomAnotherClientStopsIsToldAndDrivesOnOnceTheKeyWasLetGo()
        {
            TeleopDriver driver = Driver();
            List<string> told = new();
            int fromInspector = 0;
            driver.StatusChanged += told.Add;
            driver.OnStatus.AddListener(words => fromInspector++);
            yield return Clear();
            yield return Hold(driver);
            Assert.AreEqual("you drive", driver.Status);
            _scene.Observer.StopRobots();
            yield return _scene.Until(() => IsStopped(driver.Control), "to be stopped");
            yield return _scene.UntilHeard(0, 0);
            _scene.Heard.Clear();
            yield return _scene.Until(
                () => driver.Status == "stopped, another client asked for a stop: let go (publish zero), then drive on",
                "to be told");
            // The key is held, and nothing goes: the lease ends.
            yield return _scene.Until(() => driver.Control.Holder == ControlHolder.None, "for the lease to end");
            Assert.IsTrue(driver.Control.IsTripped);
            Assert.IsFalse(_scene.HasHeard(Speed, 0));
            _keys.Held = DriveKeys.None;
            yield return _scene.Until(() => !driver.Control.IsTripped, "for the reset");
            yield return Hold(driver);
            CollectionAssert.Contains(told, "you drive");
            Assert.AreEqual(told.Count, fromInspector);
            driver.enabled = false;
            Assert.AreEqual("", driver.Status);
            Assert.IsNull(driver.Control);
        }

        [UnityTest]
        public IEnumerator ADriverWhoseRobotWasStoppedWhileNoKeyIsHeldSendsTheZeroByItself()
        {
            TeleopDriver driver = Driver();
            yield return Clear();
            yield return Hold(driver);
            driver.SendMessage("OnApplicationFocus", false); // keys are let go of, and a zero goes
            _scene.Observer.StopRobots();
            yield return _scene.Until(() => IsStopped(driver.Control), "to be stopped");
            yield return _scene.Until(() => !driver.Control.IsTripped, "for the reset");
        }

        [UnityTest]
        public IEnumerator ADriverThatHasNotDrivenLeavesTheLatchToWhoHas()
        {
            TeleopDriver driver = Driver();
            yield return Clear();
            yield return OtherDrives(driver);
            // the other freezes
            yield return _scene.Until(
                () => driver.Control.IsTripped && driver.Control.Holder == ControlHolder.None, "for its lease to end");
            for (int i = 0; i < AFewFrames; i++)
            {
                yield return null;
            }
            Assert.IsTrue(driver.Control.IsTripped);
            Assert.AreEqual(ControlHolder.None, driver.Control.Holder);
        }

        [UnityTest]
        public IEnumerator AKeyThatIsPressedAnewDrivesARobotThatAnotherClientHasLeftStopped()
        {
            TeleopDriver driver = Driver();
            yield return Clear();
            yield return OtherDrives(driver);
            yield return _scene.Until(
                () => driver.Control.IsTripped && driver.Control.Holder == ControlHolder.None, "for its lease to end");
            yield return Hold(driver);
        }

        [UnityTest]
        public IEnumerator StopStopsARobotThatAnotherClientDrives()
        {
            TeleopDriver driver = Driver();
            yield return Clear();
            yield return OtherDrives(driver);
            Assert.AreEqual("another client drives", driver.Status);
            _keys.StopPressed = true;
            yield return null;
            _keys.StopPressed = false;
            yield return _scene.Until(() => IsStopped(_control.State), "for the other to be stopped", Push);
        }

        [UnityTest]
        public IEnumerator ATargetIsGivenUpWithTheReasonAndTheNextIsDrivenTo()
        {
            TargetDriver driver = TargetDriver();
            string failure = null;
            driver.Failed += reason => failure = reason;
            yield return Clear();
            do
            {
                failure = null;
                yield return DriveTo(driver);
                _scene.Observer.StopRobots();
                yield return _scene.Until(() => failure != null, "to give up");
            }
            while (IsLate(failure)); // a busy machine was, before the other client could ask
            StringAssert.Contains("another client asked for", failure);
            yield return DriveTo(driver);
            driver.Stop("enough");
            yield return _scene.UntilHeard(0, 0);
            Assert.IsFalse(driver.Control.IsTripped, "who drives may stop");
        }

        [UnityTest]
        public IEnumerator WhoHearsOfAStopMayDisableTheDriverAndTheRobotIsStoppedAllTheSame(
            [Values("keys", "target")] string kind)
        {
            TargetDriver driver = TargetDriver();
            TeleopDriver keys = Driver();
            yield return Clear();
            yield return OtherDrives(keys);
            yield return _scene.Until(() => driver.SetTarget(Vector3.left), "to take the target", Push);
            driver.Failed += reason => driver.enabled = keys.enabled = false;
            if (kind == "target")
            {
                driver.Stop("pressed");
            }
            else
            {
                keys.Stop();
            }
            Assert.IsFalse(driver.enabled);
            Assert.IsFalse(keys.enabled);
            yield return _scene.Until(() => IsStopped(_control.State), "for the stop", Push);
        }

        [UnityTest]
        public IEnumerator WhoHearsThatATargetIsGivenUpMayDisableTheDriversInTheMiddleOfAFrame(
            [Values("stop", "abandon", "lost")] string how)
        {
            TargetDriver driver = TargetDriver();
            TeleopDriver keys = Driver();
            yield return Clear();
            yield return DriveTo(driver);
            driver.Failed += reason => driver.enabled = keys.enabled = false;
            switch (how)
            {
                case "stop":
                    _keys.StopPressed = true; // seen by Update
                    break;
                case "abandon":
                    driver.Abandon("enough");
                    break;
                case "lost":
                    _scene.Connection.enabled = false; // seen by Update as well
                    break;
            }
            yield return _scene.Until(() => !driver.enabled, "to give up");
            yield return _scene.UntilHeard(0, 0);
            CollectionAssert.IsEmpty(_faults);
        }

        [UnityTest]
        public IEnumerator ATargetIsRefusedWhileAnotherClientDrivesAndAbandonLeavesThatOneAlone()
        {
            TargetDriver driver = TargetDriver();
            string failure = null;
            driver.Failed += reason => failure = reason;
            yield return Clear();
            yield return OtherDrives(driver);
            driver.SetTarget(Vector3.left);
            yield return _scene.Until(() => failure != null, "to be refused", Push);
            StringAssert.Contains("another client drives", failure);
            bool wasStopped = false;
            _control.Changed += state => wasStopped |= IsStopped(state);
            driver.Abandon("the scene ends");
            _scene.Heard.Clear();
            yield return _scene.Until(
                () => _scene.Heard.FindAll(one => one.linear > 0).Count > AFewFrames || wasStopped, "to drive on", Push);
            Assert.IsFalse(wasStopped);
        }

        private void Hear(string text, string stackTrace, LogType type)
        {
            if (type == LogType.Exception)
            {
                _faults.Add(text);
            }
        }

        private static bool IsLate(string refusal) =>
            refusal.Contains("commands stopped arriving") || refusal.Contains("250 ms old");

        private static bool IsStopped(ControlState state)
        {
            return state.IsTripped && state.Cause == "stop"; // the cause alone may be another test's
        }

        private TeleopDriver Driver()
        {
            GameObject holder = _scene.New("driver");
            TeleopDriver driver = holder.AddComponent<TeleopDriver>();
            driver.Topic = Topic;
            driver.LinearSpeed = Speed;
            driver.Input = _keys;
            holder.SetActive(true);
            return driver;
        }

        private TargetDriver TargetDriver()
        {
            GameObject holder = _scene.New("driver");
            TargetDriver driver = holder.AddComponent<TargetDriver>();
            driver.Topic = Topic;
            driver.OdometryTopic = "/driving_under_control/odom";
            Publisher<OdometryMsg> odometry = _scene.Observer.Advertise<OdometryMsg>(driver.OdometryTopic);
            OdometryMsg origin = new();
            _scene.EachFrame = () =>
            {
                if (_scene.Observer.IsConnected)
                {
                    odometry.Publish(origin);
                }
            };
            holder.SetActive(true);
            return driver;
        }

        /// <summary>The traces of other tests are gone: nobody drives, and everybody may.</summary>
        private IEnumerator Clear()
        {
            yield return _scene.Until(
                () => _control.State.IsKnown && _control.State.Guard == GuardState.Ready && !_control.State.IsTripped
                    && _control.State.Holder == ControlHolder.You,
                "for a reset", () => _others.Publish(new TwistMsg()));
            bool isReleased = false;
            _control.Release(reply => isReleased = reply.Ok);
            yield return _scene.Until(
                () => isReleased && _scene.Connection.Client.IsConnected, "to release control");
            yield return null; // keys that are held before there is a connection count for nothing
        }

        private IEnumerator Hold(TeleopDriver driver)
        {
            _scene.Heard.Clear();
            int frames = 0;
            yield return _scene.Until(
                () => driver.Control.Motion == RobotMotion.Moving && driver.Control.Holder == ControlHolder.You
                    && _scene.Heard.FindAll(one => one.linear > 0).Count > 2,
                "to drive",
                // again now and then. On a busy machine a key may be down before the driver knows of its connection, or
                // of a missed deadline. Then it has to be let go of
                () => _keys.Held = ++frames % PressedAnewFrames == 0 ? DriveKeys.None : DriveKeys.Forward);
            _keys.Held = DriveKeys.Forward;
            yield return null; // the driver looks at it once in a frame
        }

        private IEnumerator OtherDrives(MonoBehaviour driver)
        {
            TeleopDriver keys = driver as TeleopDriver;
            TargetDriver target = driver as TargetDriver;
            int pushed = 0;
            yield return _scene.Until(
                () =>
                {
                    ControlState state = keys != null ? keys.Control : target.Control;
                    return state.Motion == RobotMotion.Moving && state.Holder == ControlHolder.Other && ++pushed > 5;
                },
                "for the other to drive", Push);
            Push();
            yield return null;
        }

        private IEnumerator DriveTo(TargetDriver driver)
        {
            _scene.Heard.Clear();
            yield return _scene.Until(
                () => driver.Control.Motion == RobotMotion.Moving
                    && _scene.Heard.FindAll(one => one.angular > 0).Count > 2,
                "to drive",
                () =>
                {
                    if (driver.State == DriveState.Failed || driver.State == DriveState.Idle)
                    {
                        driver.SetTarget(Vector3.left); // again where a busy machine took too long
                    }
                });
        }

        private void Push()
        {
            TwistMsg ahead = new();
            ahead.linear.x = 0.05;
            if (!_others.Publish(ahead) && !IsStopped(_control.State))
            {
                // a machine that is busy with other things has held up a command: too long for the deadline, or too
                // long for that command
                _others.Publish(new TwistMsg());
            }
        }
    }
}
