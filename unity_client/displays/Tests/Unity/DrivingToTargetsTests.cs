// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections;
using NUnit.Framework;
using Ros2Gateway.Drive;
using Ros2Gateway.Messages.NavMsgs;
using Ros2Gateway.Messages.StdSrvs;
using UnityEngine;
using UnityEngine.TestTools;

namespace Ros2Gateway.Unity.Tests
{
    /// <summary>A Target Driver, with a robot of the test's own or the simulated one.</summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class DrivingToTargetsTests
    {
        private const string Topic = "/driving_to_targets/cmd_vel";
        private const string OdometryTopic = "/driving_to_targets/odom";

        private DrivingScene _scene;
        private string _failure;
        private bool _isReached;

        [SetUp]
        public void SetUp()
        {
            _failure = null;
            _isReached = false;
        }

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
        public IEnumerator StopsOfAllKindsTellTheRobotToStandAndWhy(
            [Values("stop", "focus", "pause", "disable", "quit")] string kind)
        {
            TargetDriver driver = DriverOfStandingRobot("");
            yield return Drive(driver);
            switch (kind)
            {
                case "stop":
                    driver.Stop("the grip was pressed");
                    break;
                case "focus":
                    driver.SendMessage("OnApplicationFocus", false);
                    break;
                case "pause":
                    driver.SendMessage("OnApplicationPause", true);
                    break;
                case "disable":
                    driver.enabled = false;
                    break;
                default:
                    driver.SendMessage("OnApplicationQuit", null);
                    break;
            }
            Assert.AreEqual(DriveState.Idle, driver.State);
            Assert.IsNotEmpty(_failure);
            yield return _scene.UntilHeard(0, 0);
            yield return TurnTheOtherWay(driver);
        }

        [UnityTest]
        public IEnumerator AfterALossOfTheConnectionTheRobotIsToldToStandAndNothingIsResumed(
            [Values(false, true)] bool isFrozen)
        {
            TargetDriver driver = DriverOfStandingRobot("/through");
            yield return Drive(driver);
            int before = _scene.Heard.Count;
            yield return _scene.CutAndReconnect(isFrozen);
            Assert.AreEqual("connection lost", _failure);
            yield return _scene.UntilHeard(0, 0);
            Assert.GreaterOrEqual(_scene.Heard.LastIndexOf(DriveCommand.Zero), before);
            yield return TurnTheOtherWay(driver);
        }

        [UnityTest]
        public IEnumerator AListenerThatThrowsKeepsNoDriverFromStandingAndLettingGo(
            [Values("disable", "destroy", "connection")] string kind)
        {
            LogAssert.ignoreFailingMessages = true; // that it is told is the point
            TargetDriver driver = DriverOfStandingRobot("", null, made => made.Failed += reason => Throw());
            string bound = "";
            int listed = 0;
            yield return Drive(driver);
            driver.Failed += reason => bound = driver.CommandType + "";
            driver.OnFailed.AddListener(reason => listed++);
            driver.OnFailed.AddListener(reason => Throw());
            bound = "not told";
            switch (kind)
            {
                case "disable":
                    driver.enabled = false;
                    break;
                case "destroy":
                    UnityEngine.Object.DestroyImmediate(driver);
                    break;
                default:
                    UnityEngine.Object.DestroyImmediate(_scene.Connection.gameObject);
                    break;
            }
            Assert.IsNotEmpty(_failure);
            Assert.AreEqual(1, listed);
            Assert.AreEqual("", bound, "it is told before the driver has let go");
            Assert.IsNull(driver.CommandType);
            Assert.IsNull(driver.Control);
            Assert.IsFalse(driver.SetTarget(Vector3.left));
            yield return _scene.UntilHeard(0, 0);
        }

        [UnityTest]
        public IEnumerator AListenerThatThrowsWhenATargetIsReachedHarmsNoOther()
        {
            LogAssert.ignoreFailingMessages = true; // that it is told is the point
            int listed = 0;
            TargetDriver driver = DriverOfStandingRobot("", null, made => made.Reached += Throw);
            driver.OnReached.AddListener(() => listed++);
            yield return Drive(driver);
            Assert.IsTrue(driver.SetTarget(Vector3.zero));
            yield return _scene.Until(() => _isReached, "to be there");
            Assert.AreEqual(1, listed);
            yield return _scene.UntilHeard(0, 0);
            driver.Reached -= Throw;
        }

        [UnityTest]
        public IEnumerator WhoIsToldThatTheConnectionIsGoneMayDisableTheDriver()
        {
            LogAssert.ignoreFailingMessages = true;
            TargetDriver driver = DriverOfStandingRobot("");
            yield return Drive(driver);
            GatewayConnection other = _scene.New("another connection").AddComponent<GatewayConnection>();
            other.Settings = _scene.Connection.Settings;
            other.gameObject.SetActive(true);
            driver.Failed += reason => driver.enabled = false;
            UnityEngine.Object.DestroyImmediate(_scene.Connection.gameObject);
            Assert.IsFalse(driver.enabled);
            Assert.IsNull(driver.Control, "it is bound to the other");
        }

        [UnityTest]
        public IEnumerator WithoutAConnectionThereIsNoTarget()
        {
            TargetDriver driver = DriverOfStandingRobot("");
            driver.Connection.enabled = false;
            Assert.IsFalse(driver.SetTarget(Vector3.left));
            yield return null;
            Assert.AreEqual(DriveState.Idle, driver.State);
        }

        [UnityTest]
        public IEnumerator TheMarkerIsShownWhereTheTargetIsWhileThereIsOne()
        {
            GameObject marker = new("marker");
            TargetDriver driver = DriverOfStandingRobot("", marker.transform);
            Assert.IsFalse(marker.activeSelf);
            yield return Drive(driver);
            Assert.IsTrue(marker.activeSelf);
            Assert.AreEqual(Vector3.left, marker.transform.position);
            driver.Stop("enough");
            Assert.IsFalse(marker.activeSelf);
            UnityEngine.Object.DestroyImmediate(marker);
        }

        [UnityTest]
        public IEnumerator ATargetThatIsNotFiniteEndsTheDriveAndSaysSo()
        {
            TargetDriver driver = DriverOfStandingRobot("");
            yield return Drive(driver);
            Assert.IsFalse(driver.SetTarget(new Vector3(float.NaN, 0, 0)));
            Assert.AreEqual("the target is not finite", _failure);
            yield return _scene.UntilHeard(0, 0);
        }

        [UnityTest]
        public IEnumerator SettingsThatMakeNoSenseAreAnErrorInWords()
        {
            LogAssert.Expect(LogType.Error, "Target Driver on driver: aim is finite and above 0");
            _scene = new DrivingScene(Topic);
            GameObject holder = _scene.New("driver");
            TargetDriver driver = holder.AddComponent<TargetDriver>();
            driver.Settings = new DriveSettings { aim = -1 };
            holder.SetActive(true);
            yield return null;
            Assert.IsFalse(driver.SetTarget(Vector3.left));
            driver.Stop("nothing to stop");
        }

        [UnityTest]
        public IEnumerator TheSimulatedRobotReachesTargetsOfTheSceneWithinFiveCentimetres()
        {
            _scene = new DrivingScene("/cmd_vel");
            Transform origin = _scene.New("origin").transform;
            origin.position = new Vector3(3, 1, 2);
            origin.rotation = Quaternion.Euler(0, 30, 0);
            OdometryMsg odometry = null;
            _scene.Observer.Subscribe<OdometryMsg>("/odom", message => odometry = message);
            TargetDriver driver = Driver("/cmd_vel", "/odom", origin);
            GatewayClient client = _scene.Connection.Client;
            yield return _scene.Until(() => client.IsConnected && odometry != null, "for odometry");
            bool isReset = false;
            _scene.Observer.CallService<TriggerResponse>(
                "/reset", new TriggerRequest(), reply => isReset = reply.Ok);
            yield return _scene.Until(() => isReset, "for an answer of /reset");
            odometry = null;
            yield return _scene.Until(() => odometry != null && IsNear(odometry, 0, 0), "to be at the start");

            // to the left of the robot, then back and to the right of that
            Vector3[] places = { new Vector3(-0.35f, 0, 0.1f), new Vector3(0.2f, 0.5f, 0.3f) };
            foreach (Vector3 place in places)
            {
                _isReached = false;
                while (!_isReached)
                {
                    _failure = null;
                    yield return _scene.Until(
                        () => driver.SetTarget(origin.TransformPoint(place)), "for the target to be taken");
                    yield return _scene.Until(() => _isReached || _failure != null, "for the target");
                    // a machine that stands still makes a command late, and the target is given up, as it should be
                    if (_failure != null) StringAssert.IsMatch("the command is over|commands stopped arriving", _failure);
                }
                yield return _scene.UntilHeard(0, 0);
                yield return _scene.Until(
                    () => Math.Abs(odometry.twist.twist.linear.x) < 1e-3, "for the robot to rest");
                Assert.IsTrue(IsNear(odometry, place.z, -place.x), "right is -y, ahead is x");
            }
        }

        private static void Throw() => throw new InvalidOperationException("not mine");

        private static bool IsNear(OdometryMsg odometry, double x, double y)
        {
            double missX = odometry.pose.pose.position.x - x, missY = odometry.pose.pose.position.y - y;
            return Math.Sqrt(missX * missX + missY * missY) < 0.05;
        }

        /// <summary>A robot that says where it stands, and obeys nothing.</summary>
        private TargetDriver DriverOfStandingRobot(
            string path, Transform marker = null, Action<TargetDriver> setUp = null)
        {
            _scene = new DrivingScene(Topic, path);
            Publisher<OdometryMsg> odometry = _scene.Observer.Advertise<OdometryMsg>(OdometryTopic);
            OdometryMsg origin = new();
            _scene.EachFrame = () =>
            {
                if (_scene.Observer.IsConnected)
                {
                    odometry.Publish(origin);
                }
            };
            return Driver(Topic, OdometryTopic, null, marker, setUp);
        }

        private TargetDriver Driver(
            string topic, string odometry, Transform origin, Transform marker = null, Action<TargetDriver> setUp = null)
        {
            GameObject holder = _scene.New("driver");
            TargetDriver driver = holder.AddComponent<TargetDriver>();
            driver.Topic = topic;
            driver.OdometryTopic = odometry;
            driver.Origin = origin;
            driver.Marker = marker;
            if (setUp != null)
            {
                setUp(driver);
            }
            driver.Failed += reason => _failure = reason;
            driver.Reached += () => _isReached = true;
            holder.SetActive(true);
            return driver;
        }

        /// <summary>Until the robot is told to turn left.</summary>
        private IEnumerator Drive(TargetDriver driver)
        {
            yield return _scene.Until(() => _scene.Connection.Client.IsConnected, "to be connected");
            yield return _scene.Until(() => _scene.Last.angular > 0, "for a turn", () =>
            {
                if (driver.State != DriveState.Turning && driver.State != DriveState.Waiting)
                {
                    _failure = null;
                    driver.SetTarget(Vector3.left);
                }
            });
            _failure = null;
        }

        /// <summary>
        /// A new target is driven to, and between the stop and that nothing went to the old one.
        /// </summary>
        private IEnumerator TurnTheOtherWay(TargetDriver driver)
        {
            int zero = _scene.Heard.LastIndexOf(DriveCommand.Zero);
            yield return null;
            driver.enabled = true;
            yield return _scene.Until(() => driver.CommandType != null, "for the type to be known");
            Assert.IsTrue(driver.SetTarget(Vector3.right));
            // again where that has failed: a gateway on a busy machine may be late to answer
            yield return _scene.Until(() => _scene.Last.angular < 0, "for a turn to the right",
                () => _ = driver.State != DriveState.Failed || driver.SetTarget(Vector3.right));
            Assert.IsFalse(_scene.Heard.FindIndex(zero, heard => heard.angular > 0) >= 0);
        }
    }
}
