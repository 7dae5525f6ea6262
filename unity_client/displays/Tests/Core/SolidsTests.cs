// SPDX-License-Identifier: Apache-2.0
using System;
using NUnit.Framework;
using Ros2Gateway.Messages.StdMsgs;
using Ros2Gateway.Shapes;

namespace Ros2Gateway.Tests
{
    [TestFixture]
    public sealed class SolidsTests
    {
        private const double Tolerance = 1e-5;

        private static readonly Rgba White = new(255, 255, 255);
        private static readonly Pose<Flu> Origin = new(default(Vector3<Flu>), Quaternion<Flu>.Identity);

        private MeshBuffer _mesh;

        [SetUp]
        public void SetUp()
        {
            _mesh = new MeshBuffer();
            _mesh.Clear(MeshKind.Triangles);
        }

        [Test]
        public void ABoxHasItsSizesInUnitysAxes()
        {
            _mesh.Box(new Pose<Flu>(new Vector3<Flu>(10, 0, 0), Quaternion<Flu>.Identity), new Vector3<Flu>(2, 4, 6), White);
            Assert.AreEqual(24, _mesh.VertexCount);
            Assert.AreEqual(36, _mesh.IndexCount);
            Bounds(new double[] { -2, -3, 9 }, new double[] { 2, 3, 11 });
            Closed(new Vector3<Ruf>(0, 0, 10));
            Assert.AreEqual(2 * 4 * 6, Volume(), Tolerance);
        }

        [Test]
        public void ACylinderStandsOnZ()
        {
            _mesh.Cylinder(Origin, new Vector3<Flu>(2, 2, 5), White);
            Bounds(new[] { -1, -2.5, -1 }, new[] { 1, 2.5, 1 });
            Closed(default(Vector3<Ruf>));
            Assert.AreEqual(Math.PI * 5, Volume(), 0.5);
        }

        [Test]
        public void ASphereIsRoundAndMayBeStretched()
        {
            _mesh.Sphere(Origin, new Vector3<Flu>(2, 2, 2), White);
            Closed(default(Vector3<Ruf>));
            for (int i = 0; i < _mesh.VertexCount; i++)
            {
                Assert.AreEqual(1, Vertex(i).Length, Tolerance);
            }
            Assert.AreEqual(4 * Math.PI / 3, Volume(), 0.3);
            _mesh.Clear(MeshKind.Triangles);
            _mesh.Sphere(Origin, new Vector3<Flu>(2, 4, 6), White);
            Bounds(new double[] { -2, -3, -1 }, new double[] { 2, 3, 1 });
        }

        [Test]
        public void AnArrowPointsAlongItsPosesX()
        {
            double half = Math.Sqrt(0.5);
            Pose<Flu> left = new(new Vector3<Flu>(0, 0, 1), new Quaternion<Flu>(0, 0, half, half));
            _mesh.Arrow(left, 0.7, 0.1, 0.3, 0.2, White);
            Bounds(new[] { -1, 0.9, -0.1 }, new[] { 0, 1.1, 0.1 });
            Assert.AreEqual(0.7 * Math.PI * 0.0025 + 0.3 * Math.PI * 0.01 / 3, Volume(), 0.001);
        }

        [TestCase(1, 0, 0)]
        [TestCase(-1, 0, 0)]
        [TestCase(0, -2, 0)]
        [TestCase(0, 0, 3)]
        [TestCase(-1, 1e-8, 0)]
        [TestCase(1, -2, 3)]
        public void AnArrowReachesFromOnePointToTheOther(double x, double y, double z)
        {
            Vector3<Flu> from = new(5, 6, 7);
            Vector3<Flu> to = from + new Vector3<Flu>(x, y, z);
            _mesh.Arrow(from, to, 0.02, 0.04, 0.1, White);
            double nearest = double.PositiveInfinity;
            for (int i = 0; i < _mesh.VertexCount; i++)
            {
                nearest = Math.Min(nearest, (Vertex(i).To<Flu>() - to).Length);
                double beyond = Math.Max(0, (Vertex(i).To<Flu>() - from).Length - (to - from).Length);
                Assert.Less(beyond, 1e-3);
            }
            Assert.Less(nearest, 1e-5);
        }

        [Test]
        public void AnArrowWithoutLengthIsNone()
        {
            _mesh.Arrow(default(Vector3<Flu>), default(Vector3<Flu>), 0.1, 0.2, 0.1, White);
            _mesh.Arrow(default(Vector3<Flu>), new Vector3<Flu>(double.NaN, 0, 0), 0.1, 0.2, 0.1, White);
            Assert.AreEqual(0, _mesh.VertexCount);
        }

        [Test]
        public void WhatFacesUpIsBrighterThanWhatFacesDown()
        {
            Rgba up = White.Lit(new Vector3<Flu>(0, 0, 1)), down = White.Lit(new Vector3<Flu>(0, 0, -1));
            Assert.Greater(up.g, down.g + 50);
            Assert.Greater(down.g, 100, "nothing is black");
            Assert.AreEqual(255, down.a);
        }

        [Test]
        public void ColoursOfMessagesAreCutToWhatThereIs()
        {
            ColorRGBAMsg color = new() { r = 2, g = -1, b = float.NaN, a = 0.5f };
            Assert.AreEqual("#ff000080", Rgba.Of(color).ToString());
            Assert.AreEqual("#ffffffff", Rgba.Of(null).ToString());
        }

        [Test]
        public void TheBufferIsBoundedAndSaysWhenItIsFull()
        {
            int boxes = MeshBuffer.MaxVertices / Solids.BoxVertices;
            for (int i = 0; i < boxes; i++)
            {
                _mesh.Box(Origin, new Vector3<Flu>(1, 1, 1), White);
            }
            Assert.IsFalse(_mesh.IsTruncated);
            _mesh.Box(Origin, new Vector3<Flu>(1, 1, 1), White);
            Assert.IsTrue(_mesh.IsTruncated);
            Assert.AreEqual(boxes * Solids.BoxVertices, _mesh.VertexCount);
            _mesh.Clear(MeshKind.Triangles);
            Assert.IsFalse(_mesh.IsTruncated);
        }

        private Vector3<Ruf> Vertex(int i) =>
            new Vector3<Ruf>(_mesh.Positions[3 * i], _mesh.Positions[3 * i + 1], _mesh.Positions[3 * i + 2]);

        private void Bounds(double[] low, double[] high)
        {
            for (int axis = 0; axis < 3; axis++)
            {
                double least = double.PositiveInfinity, most = double.NegativeInfinity;
                for (int i = 0; i < _mesh.VertexCount; i++)
                {
                    least = Math.Min(least, _mesh.Positions[3 * i + axis]);
                    most = Math.Max(most, _mesh.Positions[3 * i + axis]);
                }
                Assert.AreEqual(low[axis], least, Tolerance, "axis " + axis);
                Assert.AreEqual(high[axis], most, Tolerance, "axis " + axis);
            }
        }

        /// <summary>Each triangle is clockwise seen from outside: in Unity's left-handed axes its normal points out.</summary>
        private void Closed(Vector3<Ruf> inside)
        {
            for (int i = 0; i < _mesh.IndexCount; i += 3)
            {
                Vector3<Ruf> a = Corner(i) - inside, b = Corner(i + 1) - inside, c = Corner(i + 2) - inside;
                Assert.GreaterOrEqual(Dot(a, Cross(b - a, c - a)), -1e-9, "triangle " + i / 3);
            }
        }

        private double Volume()
        {
            double volume = 0;
            for (int i = 0; i < _mesh.IndexCount; i += 3)
            {
                volume += Dot(Corner(i), Cross(Corner(i + 1), Corner(i + 2))) / 6;
            }
            return volume;
        }

        private Vector3<Ruf> Corner(int index) => Vertex(_mesh.Indices[index]);

        private static double Dot(Vector3<Ruf> a, Vector3<Ruf> b) => a.x * b.x + a.y * b.y + a.z * b.z;

        private static Vector3<Ruf> Cross(Vector3<Ruf> a, Vector3<Ruf> b) =>
            new Vector3<Ruf>(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
    }
}
