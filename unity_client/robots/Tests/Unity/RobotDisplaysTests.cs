// SPDX-License-Identifier: Apache-2.0
using System.Collections;
using System.Collections.Generic;
using System.Text.RegularExpressions;
using NUnit.Framework;
using Ros2Gateway.Messages.SensorMsgs;
using Ros2Gateway.Messages.StdMsgs;
using UnityEngine;
using UnityEngine.TestTools;

namespace Ros2Gateway.Unity.Tests
{
    /// <summary>A robot by its description, and its joints.</summary>
    [TestFixture]
    public sealed class RobotDisplaysTests
    {
        private const string Arm = "<robot name='arm'><link name='base'>"
            + "<visual><geometry><box size='1 2 3'/></geometry></visual>"
            + "<visual><origin xyz='1 0 0'/><geometry><mesh filename='package://arm/hand.v2.stl' scale='2 3 4'/></geometry></visual>"
            + "</link><link name='upper'/><link name='finger'/>"
            + "<joint name='elbow' type='revolute'><parent link='base'/><child link='upper'/><origin xyz='0 0 1'/>"
            + "<axis xyz='0 0 1'/></joint>"
            + "<joint name='grip' type='prismatic'><parent link='upper'/><child link='finger'/><axis xyz='1 0 0'/>"
            + "<mimic joint='elbow' multiplier='0.5' offset='0.1'/></joint></robot>";

        private DisplayScene _scene;

        [SetUp]
        public void SetUp() => _scene = new DisplayScene();

        [TearDown]
        public void TearDown() => _scene.Dispose();

        [UnityTest]
        public IEnumerator ARobotIsBuiltAndItsJointsMove()
        {
            LogAssert.Expect(LogType.Warning, new Regex("no model for package://arm/hand.v2.stl"));
            RobotDescriptionDisplay robot = _scene.Display<RobotDescriptionDisplay>();
            robot.Show(new StringMsg { data = Arm });
            yield return null;
            Transform upper = robot.Link("upper"), finger = robot.Link("finger");
            Assert.AreSame(robot.transform, robot.Link("base"));
            Assert.AreSame(upper, finger.parent);
            AreClose(new Vector3(0, 1, 0), upper.localPosition);
            AreClose(new Vector3(0, 0, 0.1f), finger.localPosition);
            Assert.AreEqual(3, robot.transform.childCount, "a link, a box and a stand-in");
            Assert.IsTrue(robot.SetJoint("elbow", Mathf.PI / 2));
            AreClose(new Vector3(-0.1f - Mathf.PI / 4, 1, 0), finger.position, 1e-4f);
            Assert.IsFalse(robot.SetJoint("nobody", 1));
            robot.Show(new StringMsg { data = Arm });
            yield return null;
            Assert.AreSame(upper, robot.Link("upper"), "the same description changes nothing");
        }

        [UnityTest]
        public IEnumerator AMeshIsTheModelOfItsName()
        {
            GameObject model = _scene.Inactive("hand.v2");
            model.SetActive(true);
            RobotDescriptionDisplay robot = _scene.Display<RobotDescriptionDisplay>(
                setUp: made => made.Models = new[] { null, model });
            robot.Show(new StringMsg { data = Arm });
            yield return null;
            Transform copy = null;
            for (int i = 0; i < robot.transform.childCount; i++)
            {
                copy = robot.transform.GetChild(i).name.StartsWith("hand.v2") ? robot.transform.GetChild(i) : copy;
            }
            AreClose(new Vector3(0, 0, 1), copy.localPosition);
            AreClose(new Vector3(3, 4, 2), copy.localScale);
        }

        [UnityTest]
        public IEnumerator AnotherDescriptionReplacesARobotAndABrokenOneDoesNot()
        {
            LogAssert.Expect(LogType.Warning, new Regex("no model"));
            LogAssert.Expect(LogType.Warning, new Regex("not XML"));
            RobotDescriptionDisplay robot = _scene.Display<RobotDescriptionDisplay>();
            robot.Show(new StringMsg { data = Arm });
            yield return null;
            robot.Show(new StringMsg { data = "<robot" });
            yield return null;
            Assert.AreEqual("arm", robot.Robot.Name);
            robot.Show(new StringMsg { data = "<robot name='rock'><link name='stone'/></robot>" });
            yield return null;
            yield return null; // objects go at the end of a frame
            Assert.AreEqual("rock", robot.Robot.Name);
            Assert.AreEqual(0, robot.transform.childCount);
            Assert.IsNull(robot.Link("upper"));
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator AnArmAndItsGripperMayPublishTheirJointsApart()
        {
            LogAssert.Expect(LogType.Warning, new Regex("no model for package://arm/hand.v2.stl: a small box"));
            _scene.Connect();
            RobotDescriptionDisplay robot = _scene.Display<RobotDescriptionDisplay>(setUp: made => made.FetchMeshes = false);
            robot.Show(new StringMsg { data = Arm });
            yield return null;
            JointStateDisplay joints = _scene.Display<JointStateDisplay>(
                "/joints_apart", JointStateMsg.Type, made => made.Robot = robot);
            List<string> heard = new();
            joints.Subscriber.MessageReceived += message => heard.Add(((JointStateMsg)message).name[0]);
            using GatewayClient client = _scene.OtherProgram();
            client.Connect();
            Publisher<JointStateMsg> states = client.Advertise<JointStateMsg>("/joints_apart");
            yield return _scene.Until(() => client.IsConnected, "to be connected", () => client.Pump());
            yield return _scene.Until(
                () => heard.Count > 0, "for the first", () => states.Publish(State("wrist", 0), evenLate: true));
            for (int i = 1; i <= 10; i++)
            {
                states.Publish(State("elbow", 0.1 * i));
                states.Publish(State("grip", 0.2 * i));
                yield return _scene.Until(() => heard.FindAll(one => one == "grip").Count == i, "for the gripper");
                Assert.AreEqual(i, heard.FindAll(one => one == "elbow").Count);
                Quaternion turned = Quaternion.Euler(0, -0.1f * i * Mathf.Rad2Deg, 0);
                Assert.Less(Quaternion.Angle(turned, robot.Link("upper").localRotation), 0.01f);
                AreClose(new Vector3(0, 0, 0.2f * i), robot.Link("finger").localPosition);
            }
        }

        [UnityTest]
        public IEnumerator StatesThatDoNotFitAreSaid()
        {
            LogAssert.Expect(LogType.Warning, new Regex("no Robot Description Display"));
            LogAssert.Expect(LogType.Warning, new Regex("2 names and 1 positions"));
            JointStateDisplay joints = _scene.Display<JointStateDisplay>();
            joints.Show(new JointStateMsg());
            yield return null;
            joints.Robot = _scene.Display<RobotDescriptionDisplay>();
            joints.Show(new JointStateMsg { name = new[] { "a", "b" }, position = new double[] { 1 } });
            yield return null;
            joints.Show(new JointStateMsg { name = new[] { "a" }, position = new double[] { 1 } });
            yield return null;
            Assert.AreEqual(0, joints.Moved, "there is no robot yet");
            Assert.IsTrue(float.IsInfinity(joints.AgeSeconds));
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator TheSimulatedRobotStandsInItsFrameAndTurnsItsWheels()
        {
            _scene.Connect();
            FixedFrame origin = _scene.Fixed("base_link");
            RobotDescriptionDisplay robot = _scene.Display<RobotDescriptionDisplay>(
                "/robot_description", StringMsg.Type, made => made.transform.SetParent(origin.transform, false));
            JointStateDisplay joints = _scene.Display<JointStateDisplay>(
                "/joint_states", JointStateMsg.Type, made => made.transform.SetParent(robot.transform, false));
            yield return _scene.Until(
                () => joints.Moved == 2 && !robot.IsHidden, "for the robot", () => LogAssert.ignoreFailingMessages = true);
            AreClose(new Vector3(0, -0.01f, 0), robot.transform.position); // base_footprint is on the floor
            AreClose(new Vector3(0, 0.122f, 0), robot.Link("base_scan").position);
            Pose pose;
            float age;
            string problem;
            yield return _scene.Until(
                () => origin.TryGetPose("wheel_left_link", out pose, out age, out problem), "for the wheel's transform");
            origin.TryGetPose("wheel_left_link", out pose, out age, out problem);
            AreClose(pose.position, robot.Link("wheel_left_link").position);
        }

        private static JointStateMsg State(string joint, double position) =>
            new JointStateMsg { name = new[] { joint }, position = new[] { position } };

        private static void AreClose(Vector3 expected, Vector3 actual, float tolerance = 1e-5f) =>
            Assert.Less(Vector3.Distance(expected, actual), tolerance, expected + " and " + actual);
    }
}
