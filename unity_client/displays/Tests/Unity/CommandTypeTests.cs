// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections;
using NUnit.Framework;
using Ros2Gateway.Drive;
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Messages.NavMsgs;
using Ros2Gateway.Messages.StdMsgs;
using UnityEngine;
using UnityEngine.TestTools;

namespace Ros2Gateway.Unity.Tests
{
    /// <summary>Drivers send what the robot takes, Twist or TwistStamped, and nothing before they know.</summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class CommandTypeTests
    {
        // Nodes next to the gateway: one takes TwistStamped, of the other a test says what it takes.
        private const string Stamped = "/stamped";
        private const string Changing = "/changing";
        private const double Ahead = 0.26;
        private const int AFewFrames = 60;

        private DrivingScene _scene;
        private HeldKeys _keys;
        private Publisher<StringMsg> _takes;

        [SetUp]
        public void SetUp() => _keys = new HeldKeys();

        [TearDown]
        public void TearDown() => _scene.Dispose();

        [UnityTest]
        public IEnumerator ARobotThatTakesTwistStampedAloneIsDrivenByKeys()
        {
            yield return Begin(Stamped);
            TeleopDriver driver = Driver(Stamped + "/cmd_vel");
            long stamp = 0;
            _scene.Observer.Subscribe<Int64Msg>(Stamped + "/stamp", message => stamp = message.data);
            yield return _scene.Until(() => driver.CommandType == TwistStampedMsg.Type, "for the type");
            yield return PressAnew();
            yield return _scene.UntilHeard(Ahead, 0);
            yield return _scene.Until(() => stamp > 0, "for a stamp, by which a base tells how old a command is");
            _keys.Held = DriveKeys.None;
            yield return _scene.UntilHeard(0, 0);
        }

        [UnityTest]
        public IEnumerator ARobotThatTakesTwistStampedAloneIsDrivenToATarget()
        {
            yield return Begin(Stamped);
            Publisher<OdometryMsg> odometry = _scene.Observer.Advertise<OdometryMsg>(Stamped + "/odom");
            TargetDriver driver = _scene.New("driver").AddComponent<TargetDriver>();
            driver.Topic = Stamped + "/cmd_vel";
            driver.OdometryTopic = Stamped + "/odom";
            driver.gameObject.SetActive(true);
            OdometryMsg origin = new();
            yield return _scene.Until(() => _scene.Last.angular > 0, "for a turn to the left", () =>
            {
                odometry.Publish(origin);
                if (driver.State != DriveState.Turning && driver.State != DriveState.Waiting)
                {
                    driver.SetTarget(Vector3.left);
                }
            });
            Assert.AreEqual(TwistStampedMsg.Type, driver.CommandType);
            driver.Stop("that is all");
            yield return _scene.UntilHeard(0, 0);
        }

        [UnityTest]
        public IEnumerator BeforeARobotIsKnownNothingMovesAndAHeldKeyMustBePressedAnew(
            [Values("Twist", "TwistStamped")] string type)
        {
            yield return Begin(Changing);
            TeleopDriver driver = Driver(Changing + "/cmd_vel");
            _keys.Held = DriveKeys.Forward;
            yield return _scene.Until(
                () => driver.Status == "no robot listens to commands on /changing/cmd_vel yet", "to be told");
            Assert.IsNull(driver.CommandType);
            yield return Takes(type, () => driver.CommandType == "geometry_msgs/msg/" + type);
            yield return Frames(AFewFrames);
            Assert.IsFalse(_scene.HasHeard(Ahead, 0));
            yield return PressAnew();
            yield return _scene.UntilHeard(Ahead, 0);
        }

        [UnityTest]
        public IEnumerator ADriverThatWasEnabledAnewMovesNoRobotThatComesUpUnderAHeldKey()
        {
            yield return Begin(Changing);
            TeleopDriver driver = Driver(Changing + "/cmd_vel");
            yield return Takes("Twist", () => driver.CommandType != null);
            yield return Frames(AFewFrames); // it has seen one change
            driver.enabled = false;
            yield return Takes(
                "",
                () => _scene.Observer.Graph.TopicTypes(Changing + "/cmd_vel").Length == 0);
            driver.enabled = true;
            yield return _scene.Until(() => driver.Status.StartsWith("no robot listens to commands"), "to be told");
            _keys.Held = DriveKeys.Forward;
            yield return Frames(AFewFrames);
            yield return Takes("Twist", () => driver.CommandType != null);
            yield return Frames(AFewFrames);
            _keys.Held |= DriveKeys.Left; // marks the end
            yield return _scene.UntilHeard(0, 1.82);
            Assert.IsFalse(_scene.HasHeard(Ahead, 0));
        }

        [UnityTest]
        public IEnumerator WhenTheRobotIsExchangedWhileItIsDrivenTheDriverFollows(
            [Values("Twist", "TwistStamped")] string first)
        {
            string next = first == "Twist" ? "TwistStamped" : "Twist";
            yield return Begin(Changing);
            TeleopDriver driver = Driver(Changing + "/cmd_vel");
            yield return Takes(first, () => driver.CommandType == "geometry_msgs/msg/" + first);
            yield return PressAnew();
            yield return _scene.UntilHeard(Ahead, 0);

            // for a moment both are there
            yield return Takes("Twist TwistStamped", () => driver.CommandType == null);
            yield return Takes(next, () => driver.CommandType == "geometry_msgs/msg/" + next);
            _scene.Heard.Clear();
            yield return Frames(AFewFrames);
            Assert.IsFalse(_scene.HasHeard(Ahead, 0), "the key was not let go of");
            yield return PressAnew();
            yield return _scene.UntilHeard(Ahead, 0);
        }

        [UnityTest]
        public IEnumerator WhereBothTypesStayTheDriverGoesOnAsBefore()
        {
            yield return Begin(Changing);
            TeleopDriver driver = Driver(Changing + "/cmd_vel");
            yield return Takes("TwistStamped", () => driver.CommandType == TwistStampedMsg.Type);
            yield return Takes("TwistStamped Twist", () => driver.CommandType == null);
            yield return _scene.Until(() => driver.Status.EndsWith("waiting until one is left"), "to be told");
            yield return _scene.Until(() => driver.CommandType != null, "to settle");
            Assert.AreEqual(TwistStampedMsg.Type, driver.CommandType);
            yield return PressAnew();
            yield return _scene.UntilHeard(Ahead, 0);
            Assert.AreEqual(TwistStampedMsg.Type, driver.CommandType, "its own publisher is no reason to look again");
        }

        [UnityTest]
        public IEnumerator ATopicOfNoVelocityIsToldAndGetsNothing()
        {
            _scene = new DrivingScene(null);
            TeleopDriver driver = Driver("/odom");
            yield return _scene.Until(
                () => driver.Status == "/odom has type nav_msgs/msg/Odometry, not Twist or TwistStamped", "to be told");
            Assert.IsNull(driver.CommandType);
        }

        // Observes a robot. That of which a test says what it takes takes nothing yet.
        private IEnumerator Begin(string robot)
        {
            _scene = new DrivingScene(robot + "/heard");
            _takes = _scene.Observer.Advertise<StringMsg>(robot + "/takes");
            _scene.Observer.WatchGraph(graph => { });
            Func<bool> isGone = () => _scene.Observer.Graph != null
                && _scene.Observer.Graph.TopicTypes(robot + "/cmd_vel").Length == 0;
            return robot == Changing ? Takes("", isGone) : null;
        }

        private TeleopDriver Driver(string topic)
        {
            GameObject holder = _scene.New("driver");
            TeleopDriver driver = holder.AddComponent<TeleopDriver>();
            driver.Topic = topic;
            driver.Input = _keys;
            holder.SetActive(true);
            return driver;
        }

        /// <summary>Lets the robot take other types, until something holds.</summary>
        private IEnumerator Takes(string types, Func<bool> holds)
        {
            StringMsg message = new() { data = types };
            return _scene.Until(holds, "for a robot of '" + types + "' to be known", () => _takes.Publish(message));
        }

        private IEnumerator PressAnew()
        {
            _keys.Held = DriveKeys.None;
            yield return null;
            yield return null;
            _keys.Held = DriveKeys.Forward;
        }

        private IEnumerator Frames(int count)
        {
            for (int i = 0; i < count; i++)
            {
                _scene.Observer.Pump();
                yield return null;
            }
        }
    }
}
