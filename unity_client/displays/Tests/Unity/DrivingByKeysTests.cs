// SPDX-License-Identifier: Apache-2.0
using System.Collections;
using System.Collections.Generic;
using NUnit.Framework;
using Ros2Gateway.Drive;
using Ros2Gateway.Messages.GeometryMsgs;
using UnityEngine;
using UnityEngine.TestTools;

namespace Ros2Gateway.Unity.Tests
{
    /// <summary>
    /// The commands of a Teleop Driver, as a second client hears them. Each test ends with a turn that marks the end.
    /// </summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class DrivingByKeysTests
    {
        private const string Topic = "/driving_by_keys/cmd_vel";
        private const double Ahead = 0.26;
        private const double Turn = 1.82;

        private DrivingScene _scene;
        private HeldKeys _keys;
        private TeleopDriver _driver; // the last that was made

        [SetUp]
        public void SetUp() => _keys = new HeldKeys();

        [TearDown]
        public void TearDown()
        {
            if (_scene != null)
            {
                _scene.Dispose();
                _scene = null;
            }
        }

        [UnityTest]
        public IEnumerator AHeldKeyDrivesAndItsReleaseStopsOnce()
        {
            _scene = new DrivingScene(Topic);
            Driver();
            yield return Hold();
            _keys.Held = DriveKeys.None;
            yield return _scene.UntilHeard(0, 0);
            yield return Mark();
            Assert.AreEqual(1, _scene.Heard.FindAll(heard => heard.Equals(DriveCommand.Zero)).Count);
            int zero = _scene.Heard.IndexOf(DriveCommand.Zero);
            Assert.IsFalse(_scene.Heard.FindIndex(zero, heard => heard.linear != 0) >= 0);
        }

        [UnityTest]
        public IEnumerator AStopDuringAStallOfTheNetworkIsHeardWhenItIsBack(
            [Values("release", "disable")] string kind)
        {
            LogAssert.ignoreFailingMessages = true; // commands are refused in the meantime, and it is said
            _scene = new DrivingScene(Topic, "/through");
            TeleopDriver driver = Driver();
            yield return Hold();
            bool isRefused = false;
            bool wasLost = false;
            _scene.Connection.EventHeard += happened => isRefused |= happened.Text.Contains("no answer from the gateway");
            _scene.Connection.StateChanged += state => wasLost |= state != ConnectionState.Connected;
            _scene.Connection.Client.Request("stall", null, null);
            yield return _scene.Until(() => isRefused, "for the stall to be noticed");
            if (kind == "release")
            {
                _keys.Held = DriveKeys.None;
            }
            else
            {
                driver.enabled = false;
            }
            yield return _scene.UntilHeard(0, 0);
            Assert.IsFalse(wasLost, "it was the loss that stopped it");
        }

        [UnityTest]
        public IEnumerator AnApplicationThatFreezesStopsTheRobot()
        {
            _scene = new DrivingScene(Topic);
            Driver();
            yield return Hold();
            // From here on there is no frame, and the key is held.
            bool isZero = System.Threading.SpinWait.SpinUntil(
                () =>
                {
                    _scene.Observer.Pump();
                    return _scene.Last.Equals(DriveCommand.Zero);
                },
                30000);
            Assert.IsTrue(isZero, "the robot drives on");
            yield return _scene.UntilHeard(Ahead, 0); // the next frames drive on
        }

        [UnityTest]
        public IEnumerator StopStopsEveryDriverOfTheConnection()
        {
            _scene = new DrivingScene(Topic);
            TeleopDriver driver = Driver();
            TeleopDriver other = Driver();
            yield return Hold();
            other.Stop();
            yield return _scene.UntilHeard(0, 0);
            _scene.Heard.Clear();
            yield return Mark();
            Assert.IsFalse(_scene.HasHeard(Ahead, 0));
            Assert.IsNotNull(driver);
        }

        [UnityTest]
        public IEnumerator KeysAreThoseOfTheThesis()
        {
            _scene = new DrivingScene(Topic);
            Driver();
            yield return Hold();
            _keys.Held = DriveKeys.Back;
            yield return _scene.UntilHeard(-Ahead, 0);
            _keys.Held = DriveKeys.Right;
            yield return _scene.UntilHeard(0, -Turn);
            _keys.Held = DriveKeys.Forward | DriveKeys.Left;
            yield return _scene.UntilHeard(Ahead, Turn);
        }

        [UnityTest]
        public IEnumerator AConnectionThatIsDisabledFirstSendsTheStopBeforeItLeaves()
        {
            _scene = new DrivingScene(Topic);
            Driver();
            yield return Hold();
            _scene.Connection.gameObject.SetActive(false);
            yield return _scene.UntilHeard(0, 0);
        }

        [UnityTest]
        public IEnumerator LossOfFocusOrAPauseStopsAndHeldKeysMustBePressedAnew(
            [Values("OnApplicationFocus", "OnApplicationPause")] string message)
        {
            bool isGone = message == "OnApplicationPause";
            _scene = new DrivingScene(Topic);
            TeleopDriver driver = Driver();
            yield return Hold();
            driver.SendMessage(message, isGone);
            yield return _scene.UntilHeard(0, 0);
            _scene.Heard.Clear();
            driver.SendMessage(message, !isGone);
            yield return Mark();
            Assert.IsFalse(_scene.HasHeard(Ahead, 0));
        }

        [UnityTest]
        public IEnumerator WithoutFocusNoKeyDrives()
        {
            _scene = new DrivingScene(Topic);
            TeleopDriver driver = Driver();
            yield return Hold();
            driver.SendMessage("OnApplicationFocus", false);
            yield return _scene.UntilHeard(0, 0);
            _scene.Heard.Clear();
            _keys.Held = DriveKeys.None;
            yield return null;
            _keys.Held = DriveKeys.Back;
            yield return null;
            driver.SendMessage("OnApplicationFocus", true);
            yield return Mark();
            Assert.IsFalse(_scene.HasHeard(-Ahead, 0));
        }

        [UnityTest]
        public IEnumerator DisablingStopsAndEnablingResumesNothing()
        {
            _scene = new DrivingScene(Topic);
            TeleopDriver driver = Driver();
            yield return Hold();
            driver.enabled = false;
            yield return _scene.UntilHeard(0, 0);
            _scene.Heard.Clear();
            driver.enabled = true;
            yield return _scene.Until(() => driver.CommandType != null, "for the type to be known, again");
            yield return Mark();
            Assert.IsFalse(_scene.HasHeard(Ahead, 0));
        }

        [UnityTest]
        public IEnumerator StopSendsZeroAndHeldKeysMustBePressedAnew()
        {
            _scene = new DrivingScene(Topic);
            Driver();
            yield return Hold();
            _keys.StopPressed = true;
            yield return null;
            _keys.StopPressed = false;
            yield return _scene.UntilHeard(0, 0);
            _scene.Heard.Clear();
            yield return Mark();
            Assert.IsFalse(_scene.HasHeard(Ahead, 0));
            _keys.Held = DriveKeys.None;
            yield return _scene.UntilHeard(0, 0);
            _scene.Heard.Clear();
            _keys.StopPressed = true; // zero also for what another has set in motion
            yield return _scene.UntilHeard(0, 0);
        }

        [UnityTest]
        public IEnumerator StopIsHeardInAFrameInWhichAListenerOfTheStatusThrows()
        {
            LogAssert.ignoreFailingMessages = true; // that it is told is the point
            _scene = new DrivingScene(Topic);
            Driver();
            yield return Hold();
            List<string> heard = new();
            List<string> listed = new();
            HeldKeys stop = new() { StopPressed = true };
            TeleopDriver other = _scene.New("other").AddComponent<TeleopDriver>();
            other.Topic = Topic;
            other.Input = stop;
            other.StatusChanged += status =>
            {
                other.enabled = false;
                throw new System.InvalidOperationException("by code");
            };
            other.StatusChanged += heard.Add;
            other.OnStatus.AddListener(listed.Add);
            other.gameObject.SetActive(true);
            yield return null;
            yield return null; // its first Update, in which the status is told for the first time
            Assert.IsFalse(other.enabled);
            stop.StopPressed = false;
            yield return _scene.UntilHeard(0, 0);
            Assert.Greater(heard.Count, 0);
            CollectionAssert.AreEqual(heard, listed);
        }

        [UnityTest]
        public IEnumerator KeysThatThrowKeepNoDriverFromStanding()
        {
            LogAssert.ignoreFailingMessages = true; // Unity tells of what escapes from its messages
            _scene = new DrivingScene(Topic);
            TeleopDriver driver = Driver();
            yield return Hold();
            Publisher<TwistMsg> publisher = _scene.Connection.Client.Advertise<TwistMsg>(Topic);
            TwistMsg mark = new();
            mark.linear.x = Ahead / 2;
            driver.Input = new BrokenKeys();
            driver.SendMessage("OnApplicationFocus", false);
            // At once: what stops a robot whose application freezes comes later.
            yield return _scene.Until(() => _scene.HasHeard(Ahead / 2, 0), "for the mark", () => publisher.Publish(mark));
            int at = _scene.Heard.FindIndex(heard => heard.linear < Ahead * 0.75 && heard.linear > 0);
            Assert.AreEqual(DriveCommand.Zero, _scene.Heard[at - 1]);
        }

        [UnityTest]
        public IEnumerator ANewConnectionBeginsWithZeroAndResumesNothing(
            [Values(false, true)] bool isFrozen)
        {
            _scene = new DrivingScene(Topic, "/through");
            Driver();
            yield return Hold();
            int before = _scene.Heard.Count;
            yield return _scene.CutAndReconnect(isFrozen);
            yield return _scene.UntilHeard(0, 0);
            int zero = _scene.Heard.LastIndexOf(DriveCommand.Zero);
            Assert.GreaterOrEqual(zero, before);
            yield return Mark();
            Assert.IsFalse(_scene.Heard.FindIndex(zero, heard => heard.linear != 0) >= 0);
        }

        [UnityTest]
        public IEnumerator ASpeedThatMakesNoSenseIsAnErrorInWords()
        {
            LogAssert.Expect(
                LogType.Error, "Teleop Driver on driver: speeds and rate of the keys are finite and above 0");
            _scene = new DrivingScene(Topic);
            GameObject holder = _scene.New("driver");
            TeleopDriver driver = holder.AddComponent<TeleopDriver>();
            driver.LinearSpeed = 0;
            driver.Input = _keys;
            holder.SetActive(true);
            _keys.Held = DriveKeys.Forward;
            yield return null;
            driver.Stop();
        }

        [UnityTest]
        public IEnumerator WithoutAConnectionInTheSceneNothingThrows()
        {
            GameObject holder = new("driver");
            _keys.Held = DriveKeys.Forward;
            _keys.StopPressed = true;
            TeleopDriver driver = holder.AddComponent<TeleopDriver>();
            driver.Input = _keys;
            yield return null;
            driver.Stop();
            driver.SendMessage("OnApplicationFocus", false);
            yield return null;
            Object.DestroyImmediate(holder);
        }

        /// <summary>Keys of an application's own, at fault.</summary>
        private sealed class BrokenKeys : IDriveInput
        {
            public DriveKeys Held => throw new System.InvalidOperationException("not mine");

            public bool StopPressed => false;
        }

        private TeleopDriver Driver()
        {
            GameObject holder = _scene.New("driver");
            TeleopDriver driver = holder.AddComponent<TeleopDriver>();
            driver.Topic = Topic;
            driver.Input = _keys;
            holder.SetActive(true);
            _driver = driver;
            return driver;
        }

        private IEnumerator Hold()
        {
            yield return _scene.Until(() => _driver.CommandType != null, "for the type to be known");
            yield return null; // keys that are held before it is count for nothing
            _keys.Held = DriveKeys.Forward;
            yield return _scene.UntilHeard(Ahead, 0);
        }

        /// <summary>Turns, next to what is held: everything that went before was heard before.</summary>
        private IEnumerator Mark()
        {
            yield return null;
            _keys.Held |= DriveKeys.Left;
            yield return _scene.UntilHeard(0, Turn);
        }
    }
}
