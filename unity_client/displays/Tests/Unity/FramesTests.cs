// SPDX-License-Identifier: Apache-2.0
using System.Collections;
using NUnit.Framework;
using Ros2Gateway.Messages.NavMsgs;
using Ros2Gateway.Messages.SensorMsgs;
using UnityEngine;
using UnityEngine.TestTools;

namespace Ros2Gateway.Unity.Tests
{
    /// <summary>Objects that stand where the simulated robot's frames are.</summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class FramesTests
    {
        private const float ScannerHeight = 0.122f; // above base_link
        private const float Tolerance = 1e-5f;

        private DisplayScene _scene;

        [SetUp]
        public void SetUp()
        {
            _scene = new DisplayScene();
            _scene.Connect();
        }

        [TearDown]
        public void TearDown() => _scene.Dispose();

        [UnityTest]
        public IEnumerator AFollowerStandsWhereItsFrameIsAndSaysHowOldThatIs()
        {
            FixedFrame origin = _scene.Fixed("base_link");
            FrameFollower follower = Follow(origin, "/base_scan");
            yield return _scene.Until(() => follower.AgeSeconds == 0, "for the transform");
            AreClose(new Vector3(0, ScannerHeight, 0), follower.transform.localPosition);
            Assert.IsNull(follower.Problem);
            yield return _scene.Until(
                () => follower.Output.Text == "/base_scan in base_link, 0.0 s old", "for the text");
        }

        [UnityTest]
        public IEnumerator TheFixedFrameMayStandAnywhereAndBeSmall()
        {
            FixedFrame origin = _scene.Fixed("base_link");
            origin.transform.position = new Vector3(1, 2, 3);
            origin.transform.rotation = Quaternion.Euler(0, 90, 0);
            origin.transform.localScale = new Vector3(0.1f, 0.1f, 0.1f);
            FrameFollower follower = Follow(origin, "camera_link");
            yield return _scene.Until(() => follower.AgeSeconds == 0, "for the transform");
            Assert.IsTrue(origin.TryGetPose("camera_link", out Pose pose, out float age, out string problem), problem);
            Assert.Greater(pose.position.z, 0.01f, "it is ahead");
            Vector3 expected = new Vector3(1, 2, 3)
                + 0.1f * new Vector3(pose.position.z, pose.position.y, -pose.position.x); // turned to the right
            AreClose(expected, follower.transform.position);
            Pose<Flu> back = origin.PoseOf(follower.transform);
            Assert.AreEqual(pose.position.z, back.position.x, Tolerance);
            Assert.AreEqual(pose.position.y, back.position.z, Tolerance);
        }

        [UnityTest]
        public IEnumerator AFrameThatNobodyKnowsIsTold()
        {
            LogAssert.ignoreFailingMessages = true; // the gateway's warning is in the console as well
            FrameFollower follower = Follow(_scene.Fixed("base_link"), "bas_scan");
            follower.HideAfter = 1;
            follower.gameObject.AddComponent<MeshRenderer>();
            yield return _scene.Until(
                () => follower.Problem != null && follower.Problem.Contains("bas_scan"), "for the gateway's words");
            Assert.IsTrue(float.IsInfinity(follower.AgeSeconds));
            Assert.IsTrue(follower.IsHidden);
            follower.Frame = "base_scan";
            yield return _scene.Until(() => !follower.IsHidden, "to be shown");
        }

        [UnityTest]
        public IEnumerator ADisplayBelowAFixedFrameStandsInItsMessagesFrame()
        {
            FixedFrame origin = _scene.Fixed("base_link");
            LaserScanDisplay display = _scene.Display<LaserScanDisplay>(
                "/scan", LaserScanMsg.Type, made => made.transform.SetParent(origin.transform, false));
            yield return _scene.Until(() => display.Hits > 0 && !display.IsHidden, "for the scan in its place");
            Assert.AreEqual("base_scan", display.FrameId);
            AreClose(new Vector3(0, ScannerHeight, 0), display.transform.localPosition);
        }

        [UnityTest]
        public IEnumerator ADigitalTwinMovesWithinItsOdometrysFrame()
        {
            FixedFrame origin = _scene.Fixed("base_link");
            DigitalTwin twin = _scene.Display<DigitalTwin>(
                setUp: made => made.transform.SetParent(origin.transform, false));
            OdometryMsg odometry = new();
            odometry.header.frame_id = "base_scan";
            odometry.pose.pose.position.x = 1;
            twin.Show(odometry);
            yield return _scene.Until(() => twin.FrameId == "base_scan" && !twin.IsHidden, "for the frame");
            AreClose(new Vector3(0, ScannerHeight, 1), twin.transform.localPosition);
            odometry.pose.pose.position.x = 1.5;
            twin.Show(odometry);
            Vector3 there = new(0, ScannerHeight, 1.5f);
            yield return _scene.Until(
                () => Vector3.Distance(there, twin.transform.localPosition) < Tolerance, "for the end of its way");
            twin.HideAfter = 0.001f;
            yield return _scene.Until(() => twin.IsHidden, "for it to be old");
            Assert.IsNull(twin.FrameProblem);
        }

        [UnityTest]
        public IEnumerator ADisplayIsNotDrawnWhereNobodyKnowsItsFrame()
        {
            LogAssert.ignoreFailingMessages = true;
            FixedFrame origin = _scene.Fixed("base_link");
            LaserScanDisplay display = _scene.Display<LaserScanDisplay>(
                setUp: made => made.transform.SetParent(origin.transform, false));
            LaserScanMsg scan = new() { ranges = new float[] { 1, 1 }, range_max = 2, angle_increment = 1 };
            display.Show(scan);
            yield return _scene.Until(() => display.FrameProblem != null, "for the words");
            StringAssert.Contains("frame_id is empty", display.FrameProblem);
            Assert.IsFalse(display.GetComponent<MeshRenderer>().enabled);
            scan.header.frame_id = "base_link";
            display.Show(scan);
            yield return null;
            Assert.IsTrue(display.GetComponent<MeshRenderer>().enabled);
            display.enabled = false;
            Assert.IsFalse(display.IsHidden);
        }

        [UnityTest]
        public IEnumerator ADisplayThatWasDisabledStandsInItsFrameAgain()
        {
            FixedFrame origin = _scene.Fixed("base_link");
            LaserScanDisplay display = _scene.Display<LaserScanDisplay>(
                setUp: made => made.transform.SetParent(origin.transform, false));
            LaserScanMsg scan = new() { ranges = new float[] { 1, 1 }, range_max = 2, angle_increment = 1 };
            scan.header.frame_id = "base_scan";
            display.Show(scan);
            yield return _scene.Until(() => display.FrameId == "base_scan" && !display.IsHidden, "for the scan");
            display.enabled = false;
            display.transform.localPosition = Vector3.zero;
            yield return null;
            display.enabled = true;
            yield return null; // no message has come since, nor may ever: a map is published once
            Assert.IsNull(display.FrameProblem);
            Assert.IsFalse(display.IsHidden);
            AreClose(new Vector3(0, ScannerHeight, 0), display.transform.localPosition);
        }

        [UnityTest]
        [Category("Long")]
        public IEnumerator FramesThatNobodyAsksForMakeRoom()
        {
            LogAssert.ignoreFailingMessages = true; // nobody knows these frames
            FixedFrame origin = _scene.Fixed("base_link");
            Pose pose;
            float age;
            string problem;
            for (int i = 0; i < 16; i++)
            {
                Assert.IsFalse(origin.TryGetPose("nobody_" + i, out pose, out age, out problem));
            }
            Assert.IsFalse(origin.TryGetPose("base_scan", out pose, out age, out problem));
            StringAssert.Contains("at most 16 frames", problem);
            bool isFound = false;
            yield return _scene.Until(() => isFound, "for room", () =>
            {
                isFound = origin.TryGetPose("base_scan", out pose, out age, out problem);
                origin.TryGetPose("nobody_1", out pose, out age, out problem);
            });
            Assert.IsFalse(origin.TryGetPose("nobody_16", out pose, out age, out problem));
            StringAssert.DoesNotContain("at most", problem, "the others were forgotten as well, one after the other");
        }

        [UnityTest]
        [Category("Long")]
        public IEnumerator FramesThatNobodyAsksForMakeRoomForOtherFixedFrames()
        {
            LogAssert.ignoreFailingMessages = true; // nobody knows these frames
            FixedFrame idle = _scene.Fixed("base_link");
            Pose pose;
            float age;
            string problem = null;
            for (int i = 0; i < 16; i++)
            {
                Assert.IsFalse(idle.TryGetPose("nobody_" + i, out pose, out age, out problem));
            }
            FrameFollower follower = Follow(_scene.Fixed("base_link"), "base_scan");
            yield return _scene.Until(
                () => follower.Problem != null && follower.Problem.Contains("at most 16"), "for the refusal");
            yield return _scene.Until(() => follower.Problem == null, "for room");
        }

        [UnityTest]
        public IEnumerator WithoutAFixedFrameAFollowerSaysWhatToDo()
        {
            LogAssert.Expect(LogType.Warning, new System.Text.RegularExpressions.Regex("put this below one"));
            FrameFollower follower = Follow(null, "base_link");
            yield return null;
            StringAssert.Contains("no Fixed Frame", follower.Output.Text);
        }

        private FrameFollower Follow(FixedFrame origin, string frame)
        {
            GameObject holder = _scene.Inactive("follower");
            FrameFollower follower = holder.AddComponent<FrameFollower>();
            follower.Frame = frame;
            if (origin != null)
            {
                holder.transform.SetParent(origin.transform, false);
            }
            holder.SetActive(true);
            return follower;
        }

        private static void AreClose(Vector3 expected, Vector3 actual) =>
            Assert.Less(Vector3.Distance(expected, actual), Tolerance, expected + " and " + actual);
    }
}
