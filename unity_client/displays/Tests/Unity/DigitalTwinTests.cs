// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections;
using NUnit.Framework;
using Ros2Gateway.Messages.NavMsgs;
using UnityEngine;
using UnityEngine.TestTools;

namespace Ros2Gateway.Unity.Tests
{
    [TestFixture]
    public sealed class DigitalTwinTests
    {
        private const float Tolerance = 1e-4f;

        private DisplayScene _scene;

        [SetUp]
        public void SetUp() => _scene = new DisplayScene();

        [TearDown]
        public void TearDown() => _scene.Dispose();

        [UnityTest]
        public IEnumerator TheFirstMessagePutsItInItsPlaceInTheParentsFrame()
        {
            GameObject origin = _scene.Inactive("origin");
            origin.transform.position = new Vector3(10, 0, 0);
            origin.SetActive(true);
            DigitalTwin twin = _scene.Display<DigitalTwin>(
                setUp: made => made.transform.SetParent(origin.transform, false));
            twin.Show(At(1, 2, Math.PI / 2));
            yield return null;
            AreClose(new Vector3(-2, 0, 1), twin.transform.localPosition);
            AreClose(new Vector3(8, 0, 1), twin.transform.position);
            AreClose(Vector3.left, twin.transform.forward); // a quarter turn to the left
        }

        [UnityTest]
        public IEnumerator BetweenMessagesItMovesAndNeverBeyondTheLast()
        {
            DigitalTwin twin = _scene.Display<DigitalTwin>(setUp: made => made.Smoothing = 0.2f);
            twin.Show(At(0, 0, 0));
            yield return null;
            twin.Show(At(0.5, 0, 0));
            float before = 0;
            int steps = 0;
            while (before < 0.5f - Tolerance)
            {
                yield return null;
                float z = twin.transform.localPosition.z;
                Assert.Greater(z, before, "it moves in every frame");
                Assert.LessOrEqual(z, 0.5f + Tolerance);
                steps++;
                before = z;
            }
            Assert.Greater(steps, 1);
            yield return null;
            yield return null;
            AreClose(new Vector3(0, 0, 0.5f), twin.transform.localPosition);
        }

        [UnityTest]
        public IEnumerator WithoutSmoothingAndFromFarAwayItJumps()
        {
            DigitalTwin twin = _scene.Display<DigitalTwin>(setUp: made => made.Smoothing = 1);
            twin.Show(At(0, 0, 0));
            yield return null;
            twin.Show(At(5, 0, 0));
            yield return null;
            AreClose(new Vector3(0, 0, 5), twin.transform.localPosition);
            twin.Smoothing = 0;
            twin.Show(At(5.5, 0, 0));
            yield return null;
            AreClose(new Vector3(0, 0, 5.5f), twin.transform.localPosition);
        }

        [UnityTest]
        public IEnumerator WhatIsNotFiniteIsNotFollowed(
            [Values(double.NaN, double.PositiveInfinity, 1e300)] double x)
        {
            DigitalTwin twin = _scene.Display<DigitalTwin>();
            twin.Show(At(1, 0, 0));
            yield return null;
            twin.Show(At(x, 0, 0));
            yield return null;
            AreClose(new Vector3(0, 0, 1), twin.transform.localPosition);
            OdometryMsg noOrientation = At(1, 0, 0);
            noOrientation.pose.pose.orientation.w = double.NaN;
            twin.Show(noOrientation);
            yield return null;
            AreClose(Vector3.forward, twin.transform.forward);
        }

        [UnityTest]
        public IEnumerator WhatIsStaleIsHiddenAndComesBack()
        {
            MeshRenderer body = null;
            MeshRenderer off = null;
            DigitalTwin twin = _scene.Display<DigitalTwin>(setUp: made =>
            {
                made.HideAfter = 0.1f;
                body = Part(made);
                off = Part(made);
                off.enabled = false;
            });
            twin.Show(At(0, 0, 0));
            yield return null;
            Assert.IsTrue(body.enabled);
            yield return _scene.Until(() => !body.enabled, "for it to be hidden");
            twin.Show(At(0, 0, 0));
            yield return null;
            Assert.IsTrue(body.enabled);
            Assert.IsFalse(off.enabled, "what was off stays off");
        }

        private static MeshRenderer Part(DigitalTwin twin)
        {
            GameObject part = new("part");
            part.transform.SetParent(twin.transform, false);
            return part.AddComponent<MeshRenderer>();
        }

        private static OdometryMsg At(double x, double y, double yaw)
        {
            OdometryMsg message = new();
            message.pose.pose.position.x = x;
            message.pose.pose.position.y = y;
            message.pose.pose.orientation.z = Math.Sin(yaw / 2);
            message.pose.pose.orientation.w = Math.Cos(yaw / 2);
            return message;
        }

        private static void AreClose(Vector3 expected, Vector3 actual) =>
            Assert.Less(Vector3.Distance(expected, actual), Tolerance, expected + " expected, got " + actual);
    }
}
