// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections;
using NUnit.Framework;
using Ros2Gateway.Messages.SensorMsgs;
using UnityEngine;
using UnityEngine.TestTools;

namespace Ros2Gateway.Unity.Tests
{
    [TestFixture]
    public sealed class PointCloudDisplayTests
    {
        private DisplayScene _scene;
        private PointCloudDisplay _display;

        [SetUp]
        public void SetUp()
        {
            _scene = new DisplayScene();
            _display = _scene.Display<PointCloudDisplay>();
        }

        [TearDown]
        public void TearDown() => _scene.Dispose();

        private Mesh Mesh => _display.GetComponent<MeshFilter>().sharedMesh;

        [UnityTest]
        public IEnumerator PointsStandWhereRosSaysInUnitysFrame()
        {
            _display.Show(Cloud(new float[] { 1, 2, 3, -4, 0, 0.5f }));
            yield return null;
            Vector3[] expected = { new Vector3(-2, 3, 1), new Vector3(0, 0.5f, -4) };
            CollectionAssert.AreEqual(expected, Mesh.vertices);
            CollectionAssert.AreEqual(new[] { 0, 1 }, Mesh.GetIndices(0));
            Assert.AreEqual(MeshTopology.Points, Mesh.GetTopology(0));
            Assert.AreEqual(UnityEngine.Rendering.IndexFormat.UInt32, Mesh.indexFormat);
        }

        [UnityTest]
        public IEnumerator FieldsMayStandAnywhereInAnyByteOrderWithGapsBetweenRows(
            [Values(false, true)] bool isBigEndian)
        {
            PointCloud2Msg cloud = new()
            {
                width = 2,
                height = 2,
                point_step = 20,
                row_step = 47,
                is_bigendian = isBigEndian,
                data = new byte[94],
                fields = new[] { Field("z", 2), Field("intensity", 0, 4), Field("x", 14), Field("y", 7) },
            };
            for (int i = 0; i < 4; i++)
            {
                int at = i / 2 * 47 + i % 2 * 20;
                Put(cloud, at + 14, i + 0.25f);
                Put(cloud, at + 7, i + 10);
                Put(cloud, at + 2, i + 20);
            }
            _display.Show(cloud);
            yield return null;
            Vector3[] expected = new Vector3[4];
            for (int i = 0; i < 4; i++)
            {
                expected[i] = new Vector3(-(i + 10), i + 20, i + 0.25f);
            }
            CollectionAssert.AreEqual(expected, Mesh.vertices);
        }

        [UnityTest]
        public IEnumerator ColoursAreThoseOfThePoints(
            [Values("rgb", "rgba")] string name,
            [Values(PointFieldMsg.FLOAT32, PointFieldMsg.UINT32)] byte datatype)
        {
            PointCloud2Msg cloud = new()
            {
                width = 1,
                height = 1,
                point_step = 16,
                data = new byte[16],
                fields = new[] { Field("x", 0), Field("y", 4), Field("z", 8), Field(name, 12, datatype) },
            };
            new byte[] { 3, 2, 1, 128 }.CopyTo(cloud.data, 12); // 0x80010203
            _display.Show(cloud);
            yield return null;
            byte alpha = name == "rgba" ? (byte)128 : (byte)255;
            Assert.AreEqual(new Color32(1, 2, 3, alpha), Mesh.colors32[0]);
        }

        [UnityTest]
        public IEnumerator PointsThatAreNoneAreLeftOut()
        {
            _display.Show(Cloud(new[]
            {
                1, float.NaN, 3,
                1, 2, 3,
                float.PositiveInfinity, 0, 0,
                float.NegativeInfinity, float.PositiveInfinity, 0,
            }));
            yield return null;
            CollectionAssert.AreEqual(new[] { new Vector3(-2, 3, 1) }, Mesh.vertices);
        }

        [UnityTest]
        public IEnumerator OfLargeCloudsEveryNthPointIsDrawn()
        {
            float[] values = new float[3 * 1000];
            for (int i = 0; i < 1000; i++)
            {
                values[3 * i] = i;
            }
            _display.MaxPoints = 300;
            _display.Show(Cloud(values));
            yield return null;
            Assert.AreEqual(250, _display.Drawn);
            Assert.AreEqual(996, Mesh.vertices[249].z);
        }

        [UnityTest]
        public IEnumerator WhatIsWrongWithACloudIsSaidAndTheNextOneIsDrawn(
            [Values(0, 1, 2, 3, 4, 5, 6)] int kind)
        {
            PointCloud2Msg cloud = Cloud(new float[] { 1, 2, 3, 4, 5, 6 });
            cloud.height = 2;
            cloud.width = 1;
            string words = Spoil(cloud, kind);
            _display.Show(cloud);
            yield return null;
            Assert.IsTrue(_scene.HasLogged(words), string.Join("\n", _scene.Logged));
            _display.Show(Cloud(new float[] { 1, 2, 3 }));
            yield return null;
            Assert.AreEqual(1, _display.Drawn);
        }

        [UnityTest]
        public IEnumerator OfTruncatedDataTheWholePointsAreDrawn()
        {
            PointCloud2Msg cloud = Cloud(new float[] { 1, 2, 3, 4, 5, 6 });
            Array.Resize(ref cloud.data, 20);
            _display.Show(cloud);
            yield return null;
            Assert.AreEqual(1, _display.Drawn);
            Assert.IsTrue(_scene.HasLogged("data end before its points"));
        }

        [UnityTest]
        public IEnumerator OfSizesThatAreNotTrueWhatIsThereIsDrawn()
        {
            PointCloud2Msg cloud = Cloud(new float[] { 1, 2, 3, 4, 5, 6, 7, 8, 9 });
            cloud.width = uint.MaxValue;
            _display.Show(cloud);
            yield return null;
            Assert.AreEqual(3, _display.Drawn);
            cloud.width = 1;
            cloud.height = uint.MaxValue;
            cloud.row_step = 30; // the second row is beyond the data by half
            _display.Show(cloud);
            yield return null;
            Assert.AreEqual(1, _display.Drawn);
            cloud.width = uint.MaxValue;
            cloud.row_step = uint.MaxValue;
            _display.Show(cloud);
            yield return null;
            Assert.AreEqual(0, _display.Drawn);
        }

        [UnityTest]
        public IEnumerator AnEmptyCloudIsDrawnAsNothing()
        {
            _display.Show(Cloud(new float[] { 1, 2, 3 }));
            yield return null;
            _display.Show(Cloud(new float[0]));
            yield return null;
            Assert.AreEqual(0, Mesh.vertexCount);
            Assert.IsFalse(_scene.HasLogged("PointCloudDisplay on PointCloudDisplay: a"));
        }

        private static string Spoil(PointCloud2Msg cloud, int kind)
        {
            switch (kind)
            {
                case 0:
                    cloud.fields = new[] { Field("x", 0), Field("y", 4) };
                    return "needs the fields x, y and z";
                case 1:
                    cloud.fields[1].offset = uint.MaxValue;
                    return "field y needs 4 bytes at offset 4294967295, point_step is 12";
                case 2:
                    cloud.fields[2].datatype = PointFieldMsg.FLOAT64;
                    return "field z has datatype 8, expected 7 (float32)";
                case 3:
                    cloud.point_step = 0;
                    return "point_step is 0";
                case 4:
                    cloud.row_step = 11;
                    return "a row of 1 points needs 12 bytes, row_step is 11";
                case 5:
                    cloud.data = null;
                    return "data end before its points";
                default:
                    cloud.fields = null;
                    return "needs the fields x, y and z";
            }
        }

        private static PointCloud2Msg Cloud(float[] values)
        {
            PointCloud2Msg cloud = new()
            {
                width = (uint)values.Length / 3,
                height = 1,
                point_step = 12,
                row_step = 12,
                data = new byte[4 * values.Length],
                fields = new[] { Field("x", 0), Field("y", 4), Field("z", 8) },
            };
            for (int i = 0; i < values.Length; i++)
            {
                Put(cloud, 4 * i, values[i]);
            }
            return cloud;
        }

        private static PointFieldMsg Field(string name, uint offset, byte datatype = PointFieldMsg.FLOAT32) =>
            new PointFieldMsg { name = name, offset = offset, datatype = datatype, count = 1 };

        private static void Put(PointCloud2Msg cloud, int at, float value)
        {
            byte[] bytes = BitConverter.GetBytes(value);
            if (BitConverter.IsLittleEndian == cloud.is_bigendian)
            {
                Array.Reverse(bytes);
            }
            bytes.CopyTo(cloud.data, at);
        }
    }
}
