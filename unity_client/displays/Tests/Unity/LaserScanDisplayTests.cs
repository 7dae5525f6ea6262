// SPDX-License-Identifier: Apache-2.0
using System.Collections;
using NUnit.Framework;
using Ros2Gateway.Messages.SensorMsgs;
using UnityEngine;
using UnityEngine.TestTools;

namespace Ros2Gateway.Unity.Tests
{
    [TestFixture]
    public sealed class LaserScanDisplayTests
    {
        private const float Tolerance = 1e-5f;
        private const float Quarter = Mathf.PI / 2;

        private DisplayScene _scene;
        private LaserScanDisplay _display;

        [SetUp]
        public void SetUp()
        {
            _scene = new DisplayScene();
            _display = _scene.Display<LaserScanDisplay>();
            _display.Style = LaserScanStyle.Points;
        }

        [TearDown]
        public void TearDown() => _scene.Dispose();

        private Mesh Mesh => _display.GetComponent<MeshFilter>().sharedMesh;

        [UnityTest]
        public IEnumerator BeamsGoWhereRosSaysInUnitysFrame()
        {
            _display.Show(Scan(1, 2, 3, 4)); // ahead, left, behind, right
            yield return null;
            Assert.AreEqual(4, _display.Hits);
            Assert.AreEqual(MeshTopology.Points, Mesh.GetTopology(0));
            CollectionAssert.AreEqual(new[] { 1, 2, 3, 4 }, Mesh.GetIndices(0));
            AreClose(Vector3.zero, Mesh.vertices[0]);
            AreClose(new Vector3(0, 0, 1), Mesh.vertices[1]);
            AreClose(new Vector3(-2, 0, 0), Mesh.vertices[2]);
            AreClose(new Vector3(0, 0, -3), Mesh.vertices[3]);
            AreClose(new Vector3(4, 0, 0), Mesh.vertices[4]);
        }

        [UnityTest]
        public IEnumerator AScanMayBeginAnywhereAndTurnRight()
        {
            LaserScanMsg scan = Scan(1, 2);
            scan.angle_min = Quarter;
            scan.angle_increment = -Quarter;
            _display.Show(scan);
            yield return null;
            AreClose(new Vector3(-1, 0, 0), Mesh.vertices[1]);
            AreClose(new Vector3(0, 0, 2), Mesh.vertices[2]);
        }

        [UnityTest]
        public IEnumerator WhatIsBeyondTheLimitsOrNoNumberIsLeftOut()
        {
            LaserScanMsg scan = Scan(
                1, float.NaN, float.PositiveInfinity, 0, -1, 0.05f, 11, float.NegativeInfinity, 10);
            scan.range_min = 0.1f;
            scan.range_max = 10;
            _display.Show(scan);
            yield return null;
            Assert.AreEqual(2, _display.Hits);
            _display.MaxRange = 5;
            _display.Show(scan);
            yield return null;
            Assert.AreEqual(1, _display.Hits);
            scan.range_min = scan.range_max = float.NaN; // null on the wire
            _display.MaxRange = 0;
            _display.Show(scan);
            yield return null;
            Assert.AreEqual(5, _display.Hits);
            scan.range_max = float.PositiveInfinity;
            _display.Show(scan);
            yield return null;
            Assert.AreEqual(5, _display.Hits);
        }

        [UnityTest]
        public IEnumerator AShorterScanLeavesNothingOfALongerOne()
        {
            _display.Show(Scan(1, 1, 1, 1));
            yield return null;
            _display.Show(Scan(2));
            yield return null;
            Assert.AreEqual(2, Mesh.vertexCount);
            CollectionAssert.AreEqual(new[] { 1 }, Mesh.GetIndices(0));
            _display.Show(Scan());
            yield return null;
            Assert.AreEqual(0, Mesh.vertexCount);
        }

        [UnityTest]
        public IEnumerator BeamsAreLinesFromTheSensor()
        {
            _display.Style = LaserScanStyle.Beams;
            _display.Show(Scan(1, float.NaN, 3));
            yield return null;
            Assert.AreEqual(MeshTopology.Lines, Mesh.GetTopology(0));
            CollectionAssert.AreEqual(new[] { 0, 1, 0, 2 }, Mesh.GetIndices(0));
        }

        [UnityTest]
        public IEnumerator AnOutlineJoinsWhatIsNearAndNothingElse()
        {
            _display.Style = LaserScanStyle.Outline;
            LaserScanMsg scan = Scan(1, 1.01f, 3, 3.02f);
            scan.angle_increment = 0.01f;
            _display.Show(scan);
            yield return null;
            CollectionAssert.AreEqual(new[] { 1, 2, 3, 4 }, Mesh.GetIndices(0));
        }

        [UnityTest]
        public IEnumerator ColoursTellDistanceOrIntensity()
        {
            LaserScanMsg scan = Scan(0.5f, 10);
            scan.range_max = 10;
            scan.intensities = new float[] { 0, 200 };
            _display.Show(scan);
            yield return null;
            AreClose(Color.Lerp(Color.red, Color.green, 0.05f), Mesh.colors32[1]);
            AreClose(Color.green, Mesh.colors32[2]);
            _display.Coloring = LaserScanColoring.Intensity;
            _display.Show(scan);
            yield return null;
            AreClose(Color.green, Mesh.colors32[1]);
            AreClose(Color.red, Mesh.colors32[2]);
            scan.intensities = new float[] { 1 }; // of another length: no use
            _display.Show(scan);
            yield return null;
            AreClose(Color.green, Mesh.colors32[2]);
        }

        [UnityTest]
        public IEnumerator AnglesThatAreNoNumbersAreWarnedOf()
        {
            LaserScanMsg scan = Scan(1, 2, 3);
            scan.angle_increment = float.NaN;
            _display.Show(scan);
            yield return null;
            Assert.AreEqual(0, _display.Hits);
            Assert.IsTrue(_scene.HasLogged("angles are not finite"));
            scan.angle_increment = Quarter;
            scan.ranges = null;
            scan.intensities = null;
            _display.Show(scan);
            yield return null;
            _display.Show(Scan(1, 2, 3));
            yield return null;
            Assert.AreEqual(3, _display.Hits);
        }

        [UnityTest]
        public IEnumerator OfTooManyBeamsSomeAreDrawn()
        {
            LaserScanMsg scan = new() { ranges = new float[200000], angle_increment = 1e-5f };
            for (int i = 0; i < scan.ranges.Length; i++)
            {
                scan.ranges[i] = 1;
            }
            _display.Show(scan);
            yield return null;
            Assert.AreEqual(50000, _display.Hits);
            // the last that is drawn stands where its own index says
            float angle = 199996 * 1e-5f;
            AreClose(new Vector3(-Mathf.Sin(angle), 0, Mathf.Cos(angle)), Mesh.vertices[50000], 1e-3f);
        }

        [UnityTest]
        public IEnumerator MeshAndMaterialAreDestroyedWithIt()
        {
            _display.Show(Scan(1));
            yield return null;
            Mesh mesh = Mesh;
            Material material = _display.GetComponent<MeshRenderer>().sharedMaterial;
            Assert.IsNotNull(material);
            Object.Destroy(_display.gameObject);
            yield return null;
            yield return null;
            Assert.IsTrue(mesh == null);
            Assert.IsTrue(material == null);
        }

        private static LaserScanMsg Scan(params float[] ranges) =>
            new LaserScanMsg { ranges = ranges, angle_increment = Quarter };

        private static void AreClose(Vector3 expected, Vector3 actual, float tolerance = Tolerance) =>
            Assert.Less(Vector3.Distance(expected, actual), tolerance, expected + " expected, got " + actual);

        private static void AreClose(Color32 expected, Color32 actual)
        {
            Assert.AreEqual(expected.r, actual.r, 1);
            Assert.AreEqual(expected.g, actual.g, 1);
            Assert.AreEqual(expected.b, actual.b, 1);
        }
    }
}
