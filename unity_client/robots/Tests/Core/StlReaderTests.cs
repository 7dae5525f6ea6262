// SPDX-License-Identifier: Apache-2.0
using System;
using System.Globalization;
using System.IO;
using System.Text;
using System.Threading;
using NUnit.Framework;
using Ros2Gateway.Robots;
using Ros2Gateway.Shapes;

namespace Ros2Gateway.Tests
{
    [TestFixture]
    public sealed class StlReaderTests
    {
        // on the floor, and its front up
        private static readonly float[] Flat = { 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3, 0 };

        private const string Facet = " facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 2 0 0\n   vertex 0 3 0\n"
            + "  endloop\n endfacet\n";

        private static readonly Pose<Flu> Here = new(default(Vector3<Flu>), Quaternion<Flu>.Identity);

        [TestCase("")]
        [TestCase("made by a program")]
        [TestCase("solid arm")]
        [TestCase("SOLID")]
        public void ABinaryFileIsReadWhateverItsHeaderSays(string header)
        {
            float[] second = { 0, -1, 0, 1, 0, 0, 2, 0, 0, 1, 0, 1 };
            TriangleMesh mesh = StlReader.Read(Binary(header, 2, Flat, second));
            Assert.AreEqual(2, mesh.TriangleCount);
            CollectionAssert.AreEqual(new float[] { 0, 0, 0, 2, 0, 0, 0, 3, 0, 1, 0, 0, 2, 0, 0, 1, 0, 1 }, mesh.Corners);
            CollectionAssert.AreEqual(new float[] { 0, 0, 1, 0, -1, 0 }, mesh.Normals);
        }

        [Test]
        public void AHeaderOfSpacesThatBeginsWithSolidIsStillThatOfABinaryFile() =>
            Assert.AreEqual(1, StlReader.Read(Binary("solid arm".PadRight(80), 1, Flat)).TriangleCount);

        [TestCase("solid upper arm\n{0}endsolid upper arm\n")]
        [TestCase("solid\r\n{0}endsolid\r\n")]
        [TestCase("solid\r{0}endsolid")]
        [TestCase("\n solid facet\n{0}endsolid facet")]
        [TestCase("\uFEFFsolid arm\n{0}endsolid arm\n")]
        public void AnAsciiFileIsRead(string file)
        {
            TriangleMesh mesh = Text(file.Replace("{0}", Facet));
            CollectionAssert.AreEqual(new float[] { 0, 0, 0, 2, 0, 0, 0, 3, 0 }, mesh.Corners);
            CollectionAssert.AreEqual(new float[] { 0, 0, 1 }, mesh.Normals);
        }

        [Test]
        public void AnAsciiFileMayHaveManyTrianglesSeveralSolidsAndCapitals()
        {
            StringBuilder many = new("solid a\n");
            for (int i = 0; i < 1000; i++)
            {
                many.Append(" facet normal 0 0 1 outer loop vertex " + i + " 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet");
            }
            TriangleMesh mesh = Text(many + "\nendsolid a\nsolid b\n" + Facet.ToUpperInvariant() + "endsolid b");
            Assert.AreEqual(1001, mesh.TriangleCount);
            Assert.AreEqual(9009, mesh.Corners.Length);
            Assert.AreEqual(999, mesh.Corners[999 * 9]);
            Assert.AreEqual(2, mesh.Corners[1000 * 9 + 3]);
            Assert.AreEqual(1, mesh.Normals[1000 * 3 + 2]);
        }

        [TestCase("1", 1f)]
        [TestCase("+1.5", 1.5f)]
        [TestCase("-0.25", -0.25f)]
        [TestCase(".5", 0.5f)]
        [TestCase("7.", 7f)]
        [TestCase("1.500000e+00", 1.5f)]
        [TestCase("-2.5E-3", -0.0025f)]
        [TestCase("0.1", 0.1f)]
        [TestCase("16777217", 16777216f)]
        [TestCase("0.00000000000000000000000000000000000000000000012", 0f)]
        [TestCase("123456789012345678901234567890", 1.2345679e29f)]
        [TestCase("0.1000000000000000055511151231257827", 0.1f)]
        [TestCase("3.4028235e38", float.MaxValue)]
        [TestCase("1e-400", 0f)]
        [TestCase("0e999999999999", 0f)]
        [TestCase("-0", 0f)]
        public void NumbersAreReadInEveryLocale(string number, float value)
        {
            CultureInfo culture = Thread.CurrentThread.CurrentCulture;
            Thread.CurrentThread.CurrentCulture = new CultureInfo("de-DE");
            try
            {
                Assert.AreEqual(value, Text(Solid(Facet.Replace("2 0 0", number + " 0 0"))).Corners[3]);
            }
            finally
            {
                Thread.CurrentThread.CurrentCulture = culture;
            }
        }

        [TestCase("0 0 0")]
        [TestCase("nan nan nan")]
        [TestCase("-nan(ind) 0 inf")]
        [TestCase("0 0 1e39")]
        public void ANormalThatIsMissingIsThatOfTheCorners(string normal)
        {
            CollectionAssert.AreEqual(
                new float[] { 0, 0, 1 }, Text(Solid(Facet.Replace("normal 0 0 1", "normal " + normal))).Normals);
            foreach (float value in new[] { 0, float.NaN, float.PositiveInfinity })
            {
                float[] unset = (float[])Flat.Clone();
                unset[2] = value;
                CollectionAssert.AreEqual(new float[] { 0, 0, 1 }, StlReader.Read(Binary("", 1, unset)).Normals);
            }
        }

        [Test]
        public void NormalsHaveLengthOneAndATriangleThatIsALineHasNone()
        {
            float[] big = { 0, 3, 4, 0, 0, 0, 2, 0, 0, 0, 3, 0 };
            float[] line = { 0, 0, 0, 0, 0, 0, 1, 1, 1, 2, 2, 2 };
            TriangleMesh mesh = StlReader.Read(Binary("", 2, big, line));
            CollectionAssert.AreEqual(new[] { 0, 0.6f, 0.8f, 0, 0, 0 }, mesh.Normals);
            MeshBuffer buffer = Buffer(mesh, new Vector3<Flu>(1, 1, 1));
            Assert.AreEqual(new Rgba(255, 255, 255).Lit(new Vector3<Flu>(double.NaN, 0, 0)), buffer.Colors[3]);
        }

        [TestCase("", "the STL is empty")]
        [TestCase("hello", "5 bytes, a binary one has at least 84")]
        [TestCase("solid", "line 1 of the STL: expected facet or endsolid, got the end")]
        [TestCase("solid a\nendsolid", "no triangles")]
        [TestCase("solidworks", "expected solid, got 'solidworks'")]
        [TestCase("solid a\nfacet normal 0 0", "line 2 of the STL: expected a finite number, got the end")]
        [TestCase("solid a\n\nfacet normal 0 0 1\nouter ring", "line 4 of the STL: expected loop, got 'ring'")]
        [TestCase("solid a\nfacet normal 0 0 1 outer loop vertex 1 2 endloop", "a finite number, got 'endloop'")]
        [TestCase("solid a\nfacet normal 0 0 1 outer loop vertex 1 2 1e39", "a finite number, got '1e39'")]
        [TestCase("solid a\nfacet normal 0 0 1 outer loop vertex 1 2 nan", "a finite number, got 'nan'")]
        [TestCase("solid a\nfacet normal 0 0 1 outer loop vertex 1 2 1e999999999999", "a finite number, got '1e999999999999'")]
        [TestCase("solid a\nfacet normal 0 0 1 outer loop vertex 1 2 1,5", "a finite number, got '1,5'")]
        [TestCase("solid a\nfacet normal 0 0 1 outer loop vertex 1 2 1.2.3", "a finite number, got '1.2.3'")]
        [TestCase("solid a\nfacet normal 0 0 1 outer loop vertex 1 2 -", "a finite number, got '-'")]
        [TestCase("solid a\nfacet normal 0 0 1 outer loop vertex 1 2 1e", "a finite number, got '1e'")]
        [TestCase("solid a\nfacet normal 0 0 1 outer loop vertex 1 2 1e5x", "a finite number, got '1e5x'")]
        [TestCase("solid a\nfacet normal 0 0 1 outer loop vertex 1 2 e5", "a finite number, got 'e5'")]
        [TestCase("solid a\nfacet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 1 1 0 vertex 0 1 0",
            "expected endloop, got 'vertex'")]
        [TestCase("solid a\nxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx", "got 'xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx'")]
        public void ATextThatIsNoneIsRefusedInWords(string text, string words) =>
            StringAssert.Contains(words, Assert.Throws<MeshException>(() => Text(text)).Message);

        [TestCase("solid a\n{0}", "expected facet or endsolid, got the end")]
        [TestCase("solid a\n{0}endsolid a\n{0}", "line 10 of the STL: expected solid, got 'facet'")]
        public void ATextThatIsIncompleteIsRefusedInWords(string text, string words) =>
            StringAssert.Contains(words, Assert.Throws<MeshException>(() => Text(text.Replace("{0}", Facet))).Message);

        [Test]
        public void ACountThatDoesNotFitIsRefusedAndALineBehindTheTrianglesIsNot()
        {
            Refuses(Binary("", 0), "0 triangles, must have 1 to 1000000");
            Refuses(Binary("", 2, Flat), "134 bytes, its 2 triangles take 184: it is incomplete");
            Refuses(Binary("", uint.MaxValue, Flat), "its 4294967295 triangles take 214748364834");
            Refuses(Binary("", 1, Flat, Flat), "184 bytes, its 1 triangles take 134");
            byte[] file = Binary("solid", 1, Flat);
            Array.Resize(ref file, file.Length + 49);
            Assert.AreEqual(1, StlReader.Read(file).TriangleCount);
            Array.Resize(ref file, file.Length - 50);
            Refuses(file, "133 bytes, its 1 triangles take 134");
            Assert.Throws<MeshException>(() => StlReader.Read(null));
        }

        [TestCase(float.NaN, "NaN")]
        [TestCase(float.PositiveInfinity, "infinite")]
        [TestCase(float.NegativeInfinity, "infinite")]
        public void ACoordinateThatIsNotFiniteIsRefusedInWords(float value, string words)
        {
            float[] wrong = (float[])Flat.Clone();
            wrong[11] = value;
            Refuses(Binary("", 2, Flat, wrong), "triangle 1 of the STL, counted from 0, has a coordinate that is " + words);
        }

        [Test]
        public void AMillionTrianglesAreReadAndNoMore()
        {
            byte[] file = new byte[84 + 50 * (TriangleMesh.MaxTriangles + 1)];
            BitConverter.GetBytes(TriangleMesh.MaxTriangles + 1).CopyTo(file, 80);
            Refuses(file, "1000001 triangles, must have 1 to 1000000");
            Array.Resize(ref file, file.Length - 50);
            BitConverter.GetBytes(TriangleMesh.MaxTriangles).CopyTo(file, 80);
            Assert.AreEqual(TriangleMesh.MaxTriangles, StlReader.Read(file).TriangleCount);
        }

        [Test]
        public void AnAsciiFileHasAMillionTrianglesAtMost()
        {
            byte[] facet = Encoding.ASCII.GetBytes(
                "facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet\n");
            byte[] begin = Encoding.ASCII.GetBytes("solid\n");
            byte[] file = new byte[begin.Length + facet.Length * (TriangleMesh.MaxTriangles + 1)];
            begin.CopyTo(file, 0);
            for (int i = 0; i <= TriangleMesh.MaxTriangles; i++)
            {
                facet.CopyTo(file, begin.Length + i * facet.Length);
            }
            Refuses(file, "more than 1000000 triangles");
        }

        [Test]
        public void BytesThatAreCutOffOrChangedThrowNothingElse()
        {
            byte[] text = Encoding.ASCII.GetBytes(Solid(Facet + Facet));
            byte[] binary = Binary("solid", 2, Flat, Flat);
            Random random = new(1);
            for (int i = 0; i < 2000; i++)
            {
                byte[] file = (byte[])(i % 2 == 0 ? text : binary).Clone();
                Array.Resize(ref file, random.Next(file.Length + 1));
                for (int change = random.Next(4); change > 0 && file.Length > 0; change--)
                {
                    file[random.Next(file.Length)] = (byte)random.Next(256);
                }
                try
                {
                    StlReader.Read(file);
                }
                catch (MeshException)
                {
                }
            }
        }

        [Test]
        public void TrianglesAreScaledThenPlacedAndLit()
        {
            // turned about z by a quarter, then moved
            Pose<Flu> origin = new(
                new Vector3<Flu>(10, 0, 0), new Quaternion<Flu>(0, 0, Math.Sqrt(0.5), Math.Sqrt(0.5)));
            MeshBuffer buffer = new();
            Rgba white = new(255, 255, 255);
            TriangleMesh mesh = StlReader.Read(Binary("", 1, Flat));
            Assert.AreEqual(1, mesh.AddTo(buffer, 0, origin, new Vector3<Flu>(2, 3, 4), white));
            // corners at (0, 0), (4, 0), (0, 9) on the floor, turned to (0, 0), (0, 4), (-9, 0). In Unity right, up, forward
            float[] expected = { 0, 0, 10, -4, 0, 10, 0, 0, 1 };
            for (int i = 0; i < 9; i++)
            {
                Assert.AreEqual(expected[i], buffer.Positions[i], 1e-5f, "of " + i);
            }
            Assert.AreEqual(white.Lit(new Vector3<Flu>(0, 0, 1)), buffer.Colors[0]);
            CollectionAssert.AreEqual(new[] { 0, 2, 1 }, Indices(buffer));
        }

        [TestCase(1, 1, 1, false)]
        [TestCase(-1, 1, 1, true)]
        [TestCase(1, -2, 1, true)]
        [TestCase(1, 1, -1, true)]
        [TestCase(-1, -1, 1, false)]
        [TestCase(-1, -1, -3, true)]
        public void AMirroredTriangleKeepsItsFrontOutside(double x, double y, double z, bool isMirrored)
        {
            // a tetrahedron: the front of each triangle is away from its middle, as is its light
            float[] corners = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1 };
            int[][] faces = { new[] { 0, 2, 1 }, new[] { 0, 1, 3 }, new[] { 0, 3, 2 }, new[] { 1, 2, 3 } };
            float[][] triangles = Array.ConvertAll(faces, face =>
            {
                float[] triangle = new float[12];
                for (int i = 0; i < 3; i++)
                {
                    Array.Copy(corners, 3 * face[i], triangle, 3 + 3 * i, 3);
                }
                return triangle;
            });
            MeshBuffer buffer = Buffer(StlReader.Read(Binary("", 4, triangles)), new Vector3<Flu>(x, y, z));
            Assert.AreEqual(isMirrored ? 1 : 2, buffer.Indices[1]);
            Vector3<Ruf> middle = 0.2 * new Vector3<Flu>(x, y, z).To<Ruf>();
            for (int i = 0; i < buffer.IndexCount; i += 3)
            {
                Vector3<Ruf> a = At(buffer, i), b = At(buffer, i + 1), c = At(buffer, i + 2);
                Vector3<Ruf> front = Cross(b - a, c - a); // clockwise in Unity's left-handed axes
                Vector3<Ruf> outward = a - middle;
                double along = front.x * outward.x + front.y * outward.y + front.z * outward.z;
                Assert.Greater(along, 0, "triangle " + i / 3);
                Vector3<Flu> normal = (1 / front.Length) * front.To<Flu>();
                Assert.AreEqual(
                    new Rgba(255, 255, 255).Lit(normal).r, buffer.Colors[buffer.Indices[i]].r, 1, "light of " + i / 3);
            }
        }

        [Test]
        public void WhatABufferHasNoRoomForIsLeftForTheNext()
        {
            TriangleMesh mesh = StlReader.Read(Binary("", 3, Flat, Flat, Flat));
            MeshBuffer buffer = new() { Room = 7 };
            Vector3<Flu> one = new(1, 1, 1);
            Assert.AreEqual(2, mesh.AddTo(buffer, 0, Here, one, new Rgba(1, 2, 3)));
            Assert.AreEqual(6, buffer.VertexCount);
            buffer.Clear(MeshKind.Triangles);
            Assert.AreEqual(3, mesh.AddTo(buffer, 2, Here, one, new Rgba(1, 2, 3)));
            Assert.AreEqual(3, buffer.VertexCount);
        }

        [Test]
        public void AScaleThatLeadsBeyondFloatIsRefusedInWords()
        {
            TriangleMesh mesh = StlReader.Read(Binary("", 1, Flat));
            StringAssert.Contains("farther away than float32 goes", Assert.Throws<MeshException>(
                () => Buffer(mesh, new Vector3<Flu>(1, 3e38, 1))).Message);
        }

        private static MeshBuffer Buffer(TriangleMesh mesh, Vector3<Flu> scale)
        {
            MeshBuffer buffer = new();
            mesh.AddTo(buffer, 0, Here, scale, new Rgba(255, 255, 255));
            return buffer;
        }

        private static int[] Indices(MeshBuffer buffer)
        {
            int[] indices = new int[buffer.IndexCount];
            Array.Copy(buffer.Indices, indices, indices.Length);
            return indices;
        }

        private static Vector3<Ruf> At(MeshBuffer buffer, int index)
        {
            int at = 3 * buffer.Indices[index];
            return new Vector3<Ruf>(buffer.Positions[at], buffer.Positions[at + 1], buffer.Positions[at + 2]);
        }

        private static Vector3<Ruf> Cross(Vector3<Ruf> a, Vector3<Ruf> b) =>
            new Vector3<Ruf>(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);

        private static void Refuses(byte[] stl, string words) =>
            StringAssert.Contains(words, Assert.Throws<MeshException>(() => StlReader.Read(stl)).Message);

        private static TriangleMesh Text(string text) => StlReader.Read(Encoding.UTF8.GetBytes(text));

        private static string Solid(string facets) => "solid a\n" + facets + "endsolid a\n";

        /// <summary>A binary file of triangles, each a normal and three corners.</summary>
        private static byte[] Binary(string header, uint count, params float[][] triangles)
        {
            using (MemoryStream stream = new())
            using (BinaryWriter writer = new(stream))
            {
                byte[] text = new byte[80];
                Encoding.ASCII.GetBytes(header).CopyTo(text, 0);
                writer.Write(text);
                writer.Write(count);
                foreach (float[] triangle in triangles)
                {
                    foreach (float value in triangle)
                    {
                        writer.Write(value);
                    }
                    writer.Write((ushort)0);
                }
                writer.Flush();
                return stream.ToArray();
            }
        }
    }
}
