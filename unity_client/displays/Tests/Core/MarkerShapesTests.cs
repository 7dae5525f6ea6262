// SPDX-License-Identifier: Apache-2.0
using System;
using NUnit.Framework;
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Messages.StdMsgs;
using Ros2Gateway.Messages.VisualizationMsgs;
using Ros2Gateway.Shapes;

namespace Ros2Gateway.Tests
{
    [TestFixture]
    public sealed class MarkerShapesTests
    {
        private MeshBuffer _mesh;

        [SetUp]
        public void SetUp() => _mesh = new MeshBuffer();

        [TestCase(MarkerMsg.ARROW, 2, 0.6, 0.6)]
        [TestCase(MarkerMsg.CUBE, 2, 0.3, 0.4)]
        [TestCase(MarkerMsg.SPHERE, 2, 0.3, 0.4)]
        [TestCase(MarkerMsg.CYLINDER, 2, 0.3, 0.4)]
        public void AShapeHasTheMarkersScale(int type, double x, double y, double z)
        {
            Assert.IsNull(MarkerShapes.Build(Marker(type), _mesh));
            Assert.AreEqual(MeshKind.Triangles, _mesh.Kind);
            Assert.AreEqual(x, Extent(2), 1e-5);
            Assert.AreEqual(y, Extent(0), 1e-5);
            Assert.AreEqual(z, Extent(1), 1e-5);
        }

        [Test]
        public void AMeshIsABoxAndSaysSo()
        {
            StringAssert.Contains("boxes", MarkerShapes.Build(Marker(MarkerMsg.MESH_RESOURCE), _mesh));
            Assert.AreEqual(24, _mesh.VertexCount);
        }

        [Test]
        public void AnArrowMayGoFromPointToPoint()
        {
            Assert.IsNull(MarkerShapes.Build(Marker(MarkerMsg.ARROW, 0, 0, 0, 0, 0, 5), _mesh));
            Assert.AreEqual(5, Extent(1), 1e-5);
            StringAssert.Contains("a start and an end", MarkerShapes.Build(Marker(MarkerMsg.ARROW, 0, 0, 0), _mesh));
        }

        [Test]
        public void AStripJoinsAllPointsAndAListPairs()
        {
            Assert.IsNull(MarkerShapes.Build(Marker(MarkerMsg.LINE_STRIP, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0), _mesh));
            Assert.AreEqual(MeshKind.Lines, _mesh.Kind);
            CollectionAssert.AreEqual(new[] { 0, 1, 1, 2, 2, 3 }, Indices());
            Assert.IsNull(MarkerShapes.Build(Marker(MarkerMsg.LINE_LIST, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0), _mesh));
            CollectionAssert.AreEqual(new[] { 0, 1, 2, 3 }, Indices());
        }

        [Test]
        public void ALineHasAGapWhereAPointIsNotFinite()
        {
            MarkerMsg marker = Marker(MarkerMsg.LINE_STRIP, 0, 0, 0, 1, 0, 0, double.NaN, 0, 0, 2, 0, 0, 3, 0, 0);
            StringAssert.Contains("left out", MarkerShapes.Build(marker, _mesh));
            CollectionAssert.AreEqual(new[] { 0, 1, 2, 3 }, Indices());
        }

        [TestCase(MarkerMsg.CUBE_LIST, 24)]
        [TestCase(MarkerMsg.POINTS, 24)]
        [TestCase(MarkerMsg.SPHERE_LIST, 153)]
        public void AListHasTheShapeAtEachPointInItsColour(int type, int vertices)
        {
            MarkerMsg marker = Marker(type, 0, 0, 0, 5, 0, 0);
            marker.colors = new[] { new ColorRGBAMsg { r = 1, a = 1 }, new ColorRGBAMsg { g = 1, a = 1 } };
            Assert.IsNull(MarkerShapes.Build(marker, _mesh));
            Assert.AreEqual(2 * vertices, _mesh.VertexCount);
            Assert.AreEqual(0, _mesh.Colors[0].g);
            Assert.AreEqual(0, _mesh.Colors[vertices].r);
            Assert.Greater(_mesh.Colors[vertices].g, 100);
            marker.colors = new[] { new ColorRGBAMsg { r = 1, a = 1 } };
            MarkerShapes.Build(marker, _mesh);
            Assert.Greater(_mesh.Colors[0].b, 100, "one colour for two points: the marker's");
        }

        [Test]
        public void TrianglesAreScaledAndLit()
        {
            MarkerMsg marker = Marker(MarkerMsg.TRIANGLE_LIST, 0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 5, 5);
            StringAssert.Contains("left over", MarkerShapes.Build(marker, _mesh));
            Assert.AreEqual(3, _mesh.VertexCount);
            Assert.AreEqual(2, Extent(2), 1e-5);
            Assert.AreEqual(new Rgba(255, 255, 255).Lit(new Vector3<Flu>(0, 0, 1)).g, _mesh.Colors[0].g);
        }

        [Test]
        public void ATriangleWithoutASurfaceIsNoError()
        {
            Assert.IsNull(MarkerShapes.Build(Marker(MarkerMsg.TRIANGLE_LIST, 0, 0, 0, 0, 0, 0, 0, 0, 0), _mesh));
            Assert.Greater(_mesh.Colors[0].r, 100);
        }

        [Test]
        public void ArrowsOfAStripFollowEachOther()
        {
            Assert.IsNull(MarkerShapes.Build(Marker(MarkerMsg.ARROW_STRIP, 0, 0, 0, 5, 0, 0, 5, 5, 0), _mesh));
            Assert.AreEqual(6, Extent(2), 1e-5); // the shafts are 2 m thick
            Assert.AreEqual(6, Extent(0), 1e-5);
        }

        [TestCase(-1)]
        [TestCase(13)]
        [TestCase(int.MaxValue)]
        public void AnUnknownTypeIsTold(int type)
        {
            StringAssert.Contains("type " + type + " is unknown", MarkerShapes.Build(Marker(type), _mesh));
            Assert.AreEqual(0, _mesh.VertexCount);
        }

        [Test]
        public void WhatIsMissingOrNotFiniteThrowsNothing()
        {
            for (int type = MarkerMsg.ARROW; type <= MarkerMsg.ARROW_STRIP; type++)
            {
                MarkerMsg marker = Marker(type, double.NaN, 0, 0, double.PositiveInfinity, 0, 0);
                marker.points[1] = null;
                marker.colors = null;
                marker.color = null;
                MarkerShapes.Build(marker, _mesh);
                marker.points = null;
                MarkerShapes.Build(marker, _mesh);
                marker.scale.x = double.NaN;
                StringAssert.Contains("scale is not finite", MarkerShapes.Build(marker, _mesh));
                marker.scale = null;
                StringAssert.Contains("scale is not finite", MarkerShapes.Build(marker, _mesh));
            }
        }

        [Test]
        public void AnEndlessListIsDrawnInPart()
        {
            MarkerMsg marker = Marker(MarkerMsg.CUBE_LIST);
            marker.points = new PointMsg[100000];
            for (int i = 0; i < marker.points.Length; i++)
            {
                marker.points[i] = new PointMsg();
            }
            StringAssert.Contains("only a part", MarkerShapes.Build(marker, _mesh));
            Assert.LessOrEqual(_mesh.VertexCount, MeshBuffer.MaxVertices);
        }

        private static MarkerMsg Marker(int type, params double[] coordinates)
        {
            MarkerMsg marker = new()
            {
                type = type,
                color = new ColorRGBAMsg { r = 1, g = 1, b = 1, a = 1 },
                points = new PointMsg[coordinates.Length / 3],
            };
            marker.scale.x = 2;
            marker.scale.y = 0.3;
            marker.scale.z = 0.4;
            for (int i = 0; i < marker.points.Length; i++)
            {
                marker.points[i] = new PointMsg
                {
                    x = coordinates[3 * i], y = coordinates[3 * i + 1], z = coordinates[3 * i + 2],
                };
            }
            return marker;
        }

        private double Extent(int axis)
        {
            double least = double.PositiveInfinity, most = double.NegativeInfinity;
            for (int i = 0; i < _mesh.VertexCount; i++)
            {
                least = Math.Min(least, _mesh.Positions[3 * i + axis]);
                most = Math.Max(most, _mesh.Positions[3 * i + axis]);
            }
            return most - least;
        }

        private int[] Indices()
        {
            int[] indices = new int[_mesh.IndexCount];
            Array.Copy(_mesh.Indices, indices, indices.Length);
            return indices;
        }
    }
}
