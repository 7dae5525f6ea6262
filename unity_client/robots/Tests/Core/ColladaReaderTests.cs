// SPDX-License-Identifier: Apache-2.0
using System;
using System.Globalization;
using System.Text;
using System.Threading;
using NUnit.Framework;
using Ros2Gateway.Robots;
using Ros2Gateway.Shapes;

namespace Ros2Gateway.Tests
{
    [TestFixture]
    public sealed class ColladaReaderTests
    {
        // corners 0 to 4 of a pentagon in its plane, counterclockwise
        private const string Source =
            "<source id='xyz'><float_array id='numbers' count='15'>0 0 0 2 0 0 3 1 0 1 2 0 -1 1 0</float_array>"
            + "<technique_common><accessor source='#numbers' count='5' stride='3'/></technique_common></source>"
            + "<vertices id='corners'><input semantic='POSITION' source='#xyz'/></vertices>";

        private const string Input = "<input semantic='VERTEX' source='#corners' offset='0'/>";
        private const string Triangle = "<triangles material='paint'>" + Input + "<p>0 1 2</p></triangles>";
        private const string Shown = "<instance_geometry url='#shape'/>";
        private const string Effect =
            "<library_effects><effect id='gloss'><profile_COMMON><technique><phong><diffuse>{0}</diffuse></phong></technique>"
            + "</profile_COMMON></effect></library_effects>"
            + "<library_materials><material id='{1}'><instance_effect url='#gloss'/></material></library_materials>";

        private static readonly float[] First = { 0, 0, 0, 2, 0, 0, 3, 1, 0 };

        [Test]
        public void AFileAsModellersWriteItIsRead()
        {
            const string Normals = "<input semantic='NORMAL' source='#n' offset='1'/><input semantic='TEXCOORD' source='#uv' offset='2' set='0'/>";
            string file = File(
                Geometry("<triangles count='2' material='paint'>" + Input + Normals + "<p>0 7 8 1 7 9 2 7 8\n 0 7 9 2 7 8 3 7 9</p></triangles>"),
                "<node><matrix sid='transform'>1 0 0 100 0 1 0 0 0 0 1 0 0 0 0 1</matrix><instance_geometry url='#shape'>"
                + "<bind_material><technique_common><instance_material symbol='paint' target='#red'/></technique_common></bind_material>"
                + "</instance_geometry></node>",
                "<asset><unit name='centimeter' meter='0.01'/><up_axis>Y_UP</up_axis></asset>"
                + string.Format(Effect, "<color sid='diffuse'>1 0.5 0 0.1</color>", "red"));
            TriangleMesh mesh = Read(file);
            Same(mesh.Corners, 1, 0, 0, 1.02, 0, 0, 1.03, 0.01, 0, 1, 0, 0, 1.03, 0.01, 0, 1.01, 0.02, 0);
            CollectionAssert.AreEqual(new float[] { 0, 0, 1, 0, 0, 1 }, mesh.Normals);
            CollectionAssert.AreEqual(new Rgba?[] { new Rgba(255, 128, 0), new Rgba(255, 128, 0) }, mesh.Colors, "opaque");
        }

        [TestCase("<triangles>{0}<p>0 1 2 0 2 3</p></triangles>", "012 023")]
        [TestCase("<polylist>{0}<vcount>5 3</vcount><p>0 1 2 3 4 2 3 4</p></polylist>", "012 023 034 234")]
        [TestCase("<polylist>{0}<vcount>2 3 0</vcount><p>0 1 2 3 4</p></polylist>", "234", Description = "a line is no polygon")]
        [TestCase("<polygons>{0}<p>0 1 2 3</p><ph><p>1 2 3</p><h>0 1 4</h></ph></polygons>", "012 023 123")]
        [TestCase("<tristrips>{0}<p>0 1 2 3 4</p><p>2 3 4</p></tristrips>", "012 213 234 234")]
        [TestCase("<trifans>{0}<p>0 1 2 3</p><p>1 2 3</p></trifans>", "012 023 123")]
        [TestCase("<lines>{0}<p>0 1</p></lines><triangles>{0}<p>0 1 2</p></triangles>", "012")]
        [TestCase("<triangles>{0}</triangles><triangles>{0}<p/></triangles><triangles>{0}<p>0 1 2 3</p></triangles>", "012")]
        public void PrimitivesBecomeTriangles(string primitives, string expected)
        {
            float[] corners = Read(File(Geometry(string.Format(primitives, Input)), Shown)).Corners;
            string[] places = { "0 0", "2 0", "3 1", "1 2", "-1 1" };
            StringBuilder found = new();
            for (int i = 0; i < corners.Length; i += 3)
            {
                found.Append(i > 0 && i % 9 == 0 ? " " : "").Append(Array.IndexOf(places, corners[i] + " " + corners[i + 1]));
            }
            Assert.AreEqual(expected, found.ToString());
        }

        [Test]
        public void NodesAreInNodesAndPlaceInTheirOrder()
        {
            const string Node = "<node><translate>10 0 0</translate><node><rotate>0 0 3 90</rotate><scale>2 1 -1</scale>" + Shown + "</node></node>";
            Same(Read(File(Geometry(Triangle), Node)).Corners, 10, 0, 0, 9, 6, 0, 10, 4, 0);
        }

        [Test]
        public void ATurnAboutNoAxisIsNone() =>
            CollectionAssert.AreEqual(First, Read(File(Geometry(Triangle), "<node><rotate>0 0 0 90</rotate>" + Shown + "</node>")).Corners);

        [Test]
        public void WhatIsShownAgainIsThereAgain()
        {
            string file = File(
                Geometry(Triangle), "<node><instance_node url='#two'/>" + Shown + "</node>",
                "<library_nodes><node id='two'><translate>0 0 1</translate>" + Shown + Shown + "</node></library_nodes>");
            Same(Read(file).Corners, 0, 0, 1, 2, 0, 1, 3, 1, 1, 0, 0, 1, 2, 0, 1, 3, 1, 1, 0, 0, 0, 2, 0, 0, 3, 1, 0);
        }

        [Test]
        public void TheSceneThatIsToBeShownIsElseTheFirstElseAllThatThereIs()
        {
            const string Scenes = "<library_visual_scenes><visual_scene id='a'/><visual_scene id='b'>" + Shown
                + "</visual_scene></library_visual_scenes>";
            const string Asked = "<scene><instance_visual_scene url='#b'/></scene>";
            CollectionAssert.AreEqual(First, Read(Root(Geometry(Triangle) + Scenes + Asked)).Corners);
            Refuses(Root(Geometry(Triangle) + Scenes), "shows no triangles");
            CollectionAssert.AreEqual(First, Read(Root(Geometry(Triangle))).Corners);
        }

        [Test]
        public void PositionsMayHaveMoreNumbersThanThree()
        {
            const string Wide = "<source id='xyz'><float_array id='numbers'>9 0 0 0 8 2 0 0 8 3 1 0 8</float_array>"
                + "<technique_common><accessor source='#numbers' count='3' stride='4' offset='1'/></technique_common></source>"
                + "<vertices id='corners'><input semantic='NORMAL' source='#n'/><input semantic='POSITION' source='#xyz'/></vertices>";
            CollectionAssert.AreEqual(First, Read(File(Geometry(Triangle, Wide), Shown)).Corners);
        }

        [TestCase("<color>0 1 0 1</color>", "paint", "#00ff00ff", Description = "by the material's id, as old files have it")]
        [TestCase("<color>2 -1 0</color>", "paint", "#ff0000ff")]
        [TestCase("<texture texture='skin'/>", "paint", null)]
        [TestCase("<color>0 1 0 1</color>", "other", null)]
        public void AColourIsThatOfTheMaterial(string diffuse, string id, string expected)
        {
            Rgba?[] colors = Read(File(Geometry(Triangle), Shown, string.Format(Effect, diffuse, id))).Colors;
            Assert.AreEqual(expected, colors == null ? null : colors[0].ToString());
        }

        [Test]
        public void TrianglesWithoutAColourHaveThatOfTheDescription()
        {
            string file = File(
                Geometry("<triangles>" + Input + "<p>0 1 2</p></triangles>" + Triangle), Shown,
                string.Format(Effect, "<color>1 0 0 1</color>", "paint"));
            TriangleMesh mesh = Read(file);
            CollectionAssert.AreEqual(new Rgba?[] { null, new Rgba(255, 0, 0) }, mesh.Colors);
            MeshBuffer buffer = new();
            Vector3<Flu> one = new(1, 1, 1);
            Rgba blue = new(0, 0, 255);
            mesh.AddTo(buffer, 0, new Pose<Flu>(default(Vector3<Flu>), Quaternion<Flu>.Identity), one, blue);
            Vector3<Flu> up = new(0, 0, 1);
            Assert.AreEqual(blue.Lit(up), buffer.Colors[0]);
            Assert.AreEqual(new Rgba(255, 0, 0).Lit(up), buffer.Colors[3]);
        }

        [Test]
        public void AMirroredTriangleKeepsItsFrontOutside()
        {
            string file = File(Geometry(Triangle), "<node><scale>-1 1 1</scale>" + Shown + "</node>");
            Assert.AreEqual(1, Read(file).Normals[2]);
        }

        [Test]
        public void NumbersAreReadInEveryLocale()
        {
            CultureInfo culture = Thread.CurrentThread.CurrentCulture;
            Thread.CurrentThread.CurrentCulture = new CultureInfo("de-DE");
            try
            {
                string file = File(Geometry(Triangle), Shown, "<asset><unit meter='2.5e-1'/></asset>");
                Same(Read(file).Corners, 0, 0, 0, 0.5, 0, 0, 0.75, 0.25, 0);
            }
            finally
            {
                Thread.CurrentThread.CurrentCulture = culture;
            }
        }

        [TestCase("", "the COLLADA file is empty")]
        [TestCase("solid arm", "is not XML")]
        [TestCase("<COLLADA>", "is not XML")]
        [TestCase("<!DOCTYPE a [<!ENTITY b 'c'>]><COLLADA>&b;</COLLADA>", "is not XML")]
        [TestCase("<html/>", "begins with <html>, must begin with <COLLADA>")]
        [TestCase("<COLLADA/>", "shows no triangles")]
        [TestCase("<COLLADA><asset><unit meter='0'/></asset></COLLADA>", "unit has 0 metres")]
        [TestCase("<COLLADA><asset><unit meter='1,5'/></asset></COLLADA>", "<unit meter>: expected a finite number, got '1,5'")]
        [TestCase("<COLLADA><asset><unit meter=''/></asset></COLLADA>", "<unit meter> has 0 numbers, must have 1")]
        [TestCase("<COLLADA><scene><instance_visual_scene url='#none'/></scene></COLLADA>",
            "<instance_visual_scene> refers to '#none', which is nothing in the file")]
        [TestCase("<COLLADA><scene><instance_visual_scene url='other.dae#a'/></scene></COLLADA>", "refers to 'other.dae#a'")]
        [TestCase("<COLLADA><scene><instance_visual_scene/></scene></COLLADA>", "refers to ''")]
        public void AFileThatIsNoneIsRefusedInWords(string file, string words) => Refuses(file, words);

        [TestCase("<matrix>1 0 0 0</matrix>", "<matrix> has 4 numbers, must have 16")]
        [TestCase("<translate>1 0 north</translate>", "<translate>: expected a finite number, got 'north'")]
        [TestCase("<translate>1 0 1e39</translate>", "<translate>: expected a finite number, got '1e39'")]
        [TestCase("<scale>1e30 1 1</scale><scale>1e30 1 1</scale>", "farther away than float32 goes")]
        [TestCase("<scale>1e38 1e38 1e38</scale><scale>1e38 1e38 1e38</scale><scale>1e38 1e38 1e38</scale><scale>1e38 1e38 1e38</scale>"
            + "<scale>1e38 1e38 1e38</scale><scale>1e38 1e38 1e38</scale><scale>1e38 1e38 1e38</scale><scale>1e38 1e38 1e38</scale>"
            + "<scale>1e38 1e38 1e38</scale>", "farther away than float32 goes", Description = "beyond double, too")]
        [TestCase("<skew>1 0 0 0 1 0 0</skew>", "has <skew>, which is not read")]
        [TestCase("<lookat/>", "has <lookat>, which is not read")]
        [TestCase("<instance_controller url='#skin'/>", "has <instance_controller>, which is not read")]
        [TestCase("<instance_node url='#none'/>", "<instance_node> refers to '#none'")]
        public void ANodeThatIsNotUnderstoodIsRefusedInWords(string inside, string words) =>
            Refuses(File(Geometry(Triangle), "<node>" + inside + Shown + "</node>"), words);

        [TestCase("<triangles><p>0 1 2</p></triangles>", "<triangles> has no VERTEX")]
        [TestCase("<triangles><input semantic='VERTEX' source='#xyz'/><p>0</p></triangles>", "<source> has no POSITION")]
        [TestCase("<triangles><input semantic='VERTEX' source='#corners' offset='x'/></triangles>", "<input offset>: expected an integer")]
        [TestCase("<triangles><input semantic='VERTEX' source='#corners' offset='1 2'/></triangles>", "<input> has no good offset")]
        [TestCase("<triangles><input semantic='VERTEX' source='#corners' offset='2147483647'/></triangles>", "no good offset")]
        [TestCase("<triangles><input semantic='VERTEX' source='#corners' offset='2147483648'/></triangles>", "got '2147483648'")]
        [TestCase("<triangles>{0}<p>0 1 5</p></triangles>", "<p> has position 5 of 5, counted from 0")]
        [TestCase("<triangles>{0}<p>0 1 -1</p></triangles>", "<p>: expected an integer from 0 on, got '-1'")]
        [TestCase("<triangles>{0}<p>0 1 99999999999999999999</p></triangles>", "got '99999999999999999999'")]
        [TestCase("<polylist>{0}<vcount>3 3</vcount><p>0 1 2 3</p></polylist>", "more corners in its <vcount> than in its <p>")]
        public void PrimitivesThatAreNotUnderstoodAreRefusedInWords(string primitives, string words) =>
            Refuses(File(Geometry(string.Format(primitives, Input)), Shown), words);

        [TestCase("count='5'", "count='6'", "has 6 positions of 3 numbers from 0 on, in an array of 15")]
        [TestCase("count='5'", "count='2147483646'", "has 2147483646 positions")]
        [TestCase("stride='3'", "stride='2'", "has 5 positions of 2 numbers")]
        [TestCase("stride='3'", "", "has 5 positions of 1 numbers")]
        [TestCase("<accessor source='#numbers' count='5' stride='3'/>", "", "<source> of positions has no accessor")]
        [TestCase("semantic='POSITION'", "semantic='COLOR'", "<vertices> has no POSITION")]
        [TestCase("0 0 0 2", "0 NaN 0 2", "<float_array>: expected a finite number, got 'NaN'")]
        public void PositionsThatAreNotUnderstoodAreRefusedInWords(string part, string instead, string words) =>
            Refuses(File(Geometry(Triangle, Source.Replace(part, instead)), Shown), words);

        [Test]
        public void AMillionTrianglesAreReadAndNoMore()
        {
            const int Side = 1000;
            string many = Geometry("<triangles>" + Input + "<p>" + Times("0 1 2 ", Side) + "</p></triangles>");
            Assert.AreEqual(TriangleMesh.MaxTriangles, Read(File(many, Times(Shown, Side))).TriangleCount);
            Refuses(File(many + Geometry(Triangle.Replace("corners", "more"), Source.Replace("corners", "more"), "one"),
                Times(Shown, Side) + "<instance_geometry url='#one'/>"), "more than 1000000 triangles");
        }

        [Test]
        public void OneGeometryHasAMillionTrianglesAtMostHoweverFewCornersTheyTake() =>
            Refuses(File(Geometry("<tristrips>" + Input + "<p>" + Times("0 ", 1000003) + "</p></tristrips>"), Shown),
                "more than 1000000 triangles");

        [Test]
        public void AFileOfMoreThan32MiBIsRefused()
        {
            byte[] file = new byte[(32 << 20) + 1];
            Assert.AreEqual("the COLLADA file has 33554433 bytes, at most 33554432",
                Assert.Throws<MeshException>(() => ColladaReader.Read(file)).Message);
        }

        [Test]
        public void PlacementsAreShort()
        {
            string node = "<node><translate>1 2 3" + Times(" ", 1000) + "</translate>" + Shown + "</node>";
            Refuses(File(Geometry(Triangle), node), "<translate> has more than 1000 characters");
        }

        [Test]
        public void NodesThatShowEachOtherEnd()
        {
            const string Circle = "<library_nodes><node id='a'><instance_node url='#a'/></node></library_nodes>";
            Refuses(File(Geometry(Triangle), "<node><instance_node url='#a'/></node>", Circle), "more than 100 deep, or show themselves");
            StringBuilder twice = new("<library_nodes><node id='a0'/>");
            for (int i = 1; i < 40; i++)
            {
                twice.AppendFormat("<node id='a{0}'><instance_node url='#a{1}'/><instance_node url='#a{1}'/></node>", i, i - 1);
            }
            Refuses(
                File(Geometry(Triangle), "<node><instance_node url='#a39'/></node>", twice + "</library_nodes>"), "more than 100000 nodes and parts of nodes");
        }

        [Test]
        public void ATreeThatIsTooLargeOrTooDeepIsRefused()
        {
            Refuses(Root(Times("<a b='c' d='e' f='g' h='i'/>", 200000)), "more than 1000000 elements, attributes and texts");
            Refuses(Root("<a>" + Times("x<![CDATA[y]]>", 500001) + "</a>"), "more than 1000000 elements, attributes and texts");
            Refuses(Root(Times("<a>", 101) + Times("</a>", 101)), "more than 100 elements deep");
        }

        [Test]
        public void BytesThatAreCutOffOrChangedThrowNothingElse()
        {
            byte[] whole = Encoding.UTF8.GetBytes(File(
                Geometry(Triangle), "<node><rotate>0 0 1 90</rotate>" + Shown + "</node>",
                string.Format(Effect, "<color>1 0 0 1</color>", "paint")));
            Random random = new(1);
            for (int i = 0; i < 3000; i++)
            {
                byte[] file = (byte[])whole.Clone();
                Array.Resize(ref file, i % 10 == 0 ? random.Next(file.Length + 1) : file.Length);
                for (int change = random.Next(4); change > 0 && file.Length > 0; change--)
                {
                    file[random.Next(file.Length)] = (byte)(i % 2 == 0 ? random.Next(256) : "0123456789 #<>/'=e.-"[random.Next(20)]);
                }
                try
                {
                    ColladaReader.Read(file);
                }
                catch (MeshException)
                {
                }
            }
        }

        [Test]
        public void AFileIsReadByWhatItsNameEndsIn()
        {
            byte[] collada = Encoding.UTF8.GetBytes(File(Geometry(Triangle), Shown));
            Assert.AreEqual(1, MeshReader.Read("package://arm/upper.DAE", collada).TriangleCount);
            StringAssert.Contains("STL", Assert.Throws<MeshException>(() => MeshReader.Read("a.stl", collada)).Message);
            Assert.AreEqual("expected a file that ends in .stl or .dae, got a.obj",
                Assert.Throws<MeshException>(() => MeshReader.Read("a.obj", collada)).Message);
            Assert.IsTrue(MeshReader.CanRead("a.dae"));
            Assert.IsTrue(MeshReader.CanRead("a.STL"));
            Assert.IsFalse(MeshReader.CanRead("dae"));
        }

        private static void Same(float[] found, params double[] expected)
        {
            Assert.AreEqual(expected.Length, found.Length);
            for (int i = 0; i < expected.Length; i++)
            {
                Assert.AreEqual(expected[i], found[i], 1e-6, "of " + i);
            }
        }

        private static void Refuses(string file, string words) =>
            StringAssert.Contains(words, Assert.Throws<MeshException>(() => Read(file)).Message);

        private static TriangleMesh Read(string file) => ColladaReader.Read(Encoding.UTF8.GetBytes(file));

        private static string Times(string text, int count) => new StringBuilder().Insert(0, text, count).ToString();

        private static string Geometry(string primitives, string source = Source, string id = "shape") =>
            "<library_geometries><geometry id='" + id + "'><mesh>" + source + primitives + "</mesh></geometry></library_geometries>";

        private static string File(string geometry, string nodes, string more = "") =>
            Root(more + geometry + "<library_visual_scenes><visual_scene id='all'>" + nodes
                + "</visual_scene></library_visual_scenes><scene><instance_visual_scene url='#all'/></scene>");

        private static string Root(string inside) =>
            "<?xml version='1.0' encoding='utf-8'?>\n"
                + "<COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' version='1.4.1'>" + inside + "</COLLADA>";
    }
}
