// SPDX-License-Identifier: Apache-2.0
using System;
using System.Text;
using NUnit.Framework;
using Ros2Gateway.Json;

namespace Ros2Gateway.Tests
{
    [TestFixture]
    public class JsonReaderTests
    {
        [Test]
        public void AnObjectIsReadMemberByMemberWhateverTheirOrder()
        {
            var members = new JsonMembers("x", "y", "z");
            JsonReader reader = Reading(" {\"z\" : 3 , \"x\":1,\"other\":{\"y\":[2]} ,\t\"\\u0079\": 2 } ");
            int[] values = new int[3];
            int skipped = 0;
            int member = JsonMembers.Unknown;
            reader.BeginObject();
            while (reader.NextMember(members, ref member))
            {
                if (member == JsonMembers.Unknown)
                {
                    reader.Skip();
                    skipped++;
                }
                else
                {
                    values[member] = reader.ReadInt32();
                }
            }
            reader.End();
            CollectionAssert.AreEqual(new[] { 1, 2, 3 }, values);
            Assert.AreEqual(1, skipped);
        }

        [Test]
        public void ANameThatBeginsLikeAnotherIsAnother()
        {
            var members = new JsonMembers("pose", "pose2");
            JsonReader reader = Reading("{\"pose2\":1,\"pos\":2,\"pose\":3}");
            int member = JsonMembers.Unknown;
            reader.BeginObject();
            Assert.IsTrue(reader.NextMember(members, ref member));
            Assert.AreEqual(1, member);
            reader.Skip();
            Assert.IsTrue(reader.NextMember(members, ref member));
            Assert.AreEqual(JsonMembers.Unknown, member);
            reader.Skip();
            Assert.IsTrue(reader.NextMember(members, ref member));
            Assert.AreEqual(0, member);
            reader.Skip();
            Assert.IsFalse(reader.NextMember(members, ref member));
        }

        [Test]
        public void ARawValueLiesBetweenThePositionsBeforeAndBehindIt()
        {
            const string Text = "{\"op\":\"publish\",\"msg\":{\"a\":[1,\"}\"]},\"id\":7}";
            JsonReader reader = Reading(Text);
            reader.BeginObject();
            string raw = null;
            for (string name = reader.NextName(); name != null; name = reader.NextName())
            {
                int start = reader.Position;
                reader.Skip();
                raw = name == "msg" ? Text.Substring(start, reader.Position - start) : raw;
            }
            Assert.AreEqual("{\"a\":[1,\"}\"]}", raw);
        }

        [TestCase("{}", JsonKind.Object)]
        [TestCase(" [1]", JsonKind.Array)]
        [TestCase("\n\"x\"", JsonKind.String)]
        [TestCase("\t-1", JsonKind.Number)]
        [TestCase("\r0", JsonKind.Number)]
        [TestCase("true", JsonKind.Boolean)]
        [TestCase("false", JsonKind.Boolean)]
        [TestCase("null", JsonKind.Null)]
        [TestCase("  ", JsonKind.End)]
        public void TheKindOfWhatComesNextIsKnownBeforeItIsRead(string text, JsonKind kind) =>
            Assert.AreEqual(kind, Reading(text).Kind);

        [Test]
        public void NothingOutsideTheGivenPartOfTheBufferIsRead()
        {
            byte[] buffer = Encoding.UTF8.GetBytes("99123456");
            var reader = new JsonReader();
            reader.Reset(buffer, 2, 3);
            Assert.AreEqual(123, reader.ReadInt32());
            Assert.AreEqual(5, reader.Position);
            Assert.AreEqual(JsonKind.End, reader.Kind);
            reader.End();
        }

        [TestCase(-1, 1)]
        [TestCase(0, -1)]
        [TestCase(2, 3)]
        [TestCase(int.MaxValue, 1)]
        [TestCase(1, int.MaxValue)]
        public void APartThatIsNotInTheBufferIsRefused(int offset, int count)
        {
            var reader = new JsonReader();
            Assert.Throws<ArgumentOutOfRangeException>(() => reader.Reset(new byte[4], offset, count));
        }

        [Test]
        public void AnErrorSaysWhereAndWhy()
        {
            JsonReader reader = Reading("{\"poses\":[{},{\"position\":{\"x\":\"far\"}}]}");
            JsonFormatException error = Assert.Throws<JsonFormatException>(() => ReadPoses(reader));
            Assert.AreEqual("poses[1].position.x", error.Path);
            Assert.AreEqual(30, error.Position);
            Assert.AreEqual(
                "poses[1].position.x: expected a number or null, got a string (byte 30)", error.Message);
        }

        [Test]
        public void AReaderCanBeUsedAgainAfterAnError()
        {
            JsonReader reader = Reading("{\"a\":[[");
            Assert.Throws<JsonFormatException>(() => JsonValue.Read(reader));
            Reset(reader, "[1]");
            CollectionAssert.AreEqual(new[] { 1 }, reader.ReadInt32s());
        }

        [Test]
        public void ShortTextsComeFromACache()
        {
            JsonReader reader = Reading("[\"base_link\",\"base_link\"]");
            string[] texts = reader.ReadStrings();
            Assert.AreEqual("base_link", texts[0]);
            Assert.AreSame(texts[0], texts[1]);
        }

        [Test]
        public void TextsOfEveryKindComeBack()
        {
            string[] texts =
            {
                "", "a,b]c", "ü", "\u30cf\u30ed\u30fc", "\ud83e\udd16", "\"\\/\b\f\n\r\t\u0000\u001f",
                new string('x', 100000), new string('\u00e9', 70000),
            };
            var writer = new JsonWriter();
            writer.Values(texts);
            CollectionAssert.AreEqual(texts, Reading(writer.ToString()).ReadStrings());
        }

        [Test]
        public void NullIsNaNForFloatsOnly()
        {
            float[] floats = Reading("[null,1.5]").ReadFloat32s();
            Assert.IsTrue(float.IsNaN(floats[0]));
            Assert.AreEqual(1.5f, floats[1]);
            Assert.IsTrue(double.IsNaN(Reading("null").ReadFloat64()));
            Assert.Throws<JsonFormatException>(() => Reading("null").ReadInt32());
            Assert.Throws<JsonFormatException>(() => Reading("null").ReadString());
            Assert.Throws<JsonFormatException>(() => Reading("null").ReadFloat64s());
        }

        [Test]
        public void NonFiniteFloatsAreReadByTheirNames()
        {
            const string Text = "[\"Infinity\", \"-Infinity\" ,\"NaN\",null,-0.5]";
            double[] doubles = { double.PositiveInfinity, double.NegativeInfinity, double.NaN, double.NaN, -0.5 };
            CollectionAssert.AreEqual(doubles, Reading(Text).ReadFloat64s());
            CollectionAssert.AreEqual(Array.ConvertAll(doubles, each => (float)each), Reading(Text).ReadFloat32s());
        }

        [TestCase("\"\"")]
        [TestCase("\"infinity\"")]
        [TestCase("\"Infinity")]
        [TestCase("\"+Infinity\"")]
        [TestCase("\"1\"")]
        [TestCase("Infinity")]
        public void NoOtherTextIsAFloat(string text)
        {
            Assert.Throws<JsonFormatException>(() => Reading(text).ReadFloat64());
            Assert.Throws<JsonFormatException>(() => Reading(text).ReadFloat32());
            Assert.Throws<JsonFormatException>(() => Reading("\"Infinity\"").ReadInt32());
        }

        [TestCase("[1,2]")]
        [TestCase("[1,2,3,4]")]
        [TestCase("[]")]
        public void AnArrayOfAGivenLengthMustHaveIt(string text)
        {
            Assert.Throws<JsonFormatException>(() => Reading(text).ReadFloat64s(length: 3));
            Assert.Throws<JsonFormatException>(() => Reading(text).ReadInt8s(length: 3));
            Assert.Throws<JsonFormatException>(() => Reading(text).ReadBytes(length: 3));
        }

        [Test]
        public void OctetsOfAGivenLengthMustHaveIt()
        {
            CollectionAssert.AreEqual(new byte[] { 1, 2, 3 }, Reading("\"AQID\"").ReadBytes(length: 3));
            Assert.Throws<JsonFormatException>(() => Reading("\"AQI=\"").ReadBytes(length: 3));
        }

        [Test]
        public void TextsWithCommasDoNotDisturbTheCountOfElements()
        {
            string[] texts = Reading("[\"a]\",\"b\",\"c,,,\",\"d\",\"e\",\"f\"]").ReadStrings(length: 6);
            CollectionAssert.AreEqual(new[] { "a]", "b", "c,,,", "d", "e", "f" }, texts);
        }

        [Test]
        public void ASkippedValueMustEnd()
        {
            string[] texts =
            {
                "{\"a\":[1}]", "[{\"a\":1]}", "[\"a", "[1", "{", "[[]", "tru", "-", "",
            };
            foreach (string text in texts)
            {
                Assert.Throws<JsonFormatException>(() => Reading(text).Skip(), text);
            }
        }

        [Test]
        public void WhatFollowsTheValueIsRefusedAtTheEnd()
        {
            JsonReader reader = Reading("1 2");
            reader.ReadInt32();
            JsonFormatException error = Assert.Throws<JsonFormatException>(() => reader.End());
            Assert.AreEqual("expected the end, got a number (byte 2)", error.Message);
        }

        private static void ReadPoses(JsonReader reader)
        {
            reader.BeginObject();
            reader.NextName();
            reader.BeginArray();
            while (reader.NextElement())
            {
                reader.BeginObject();
                while (reader.NextName() != null)
                {
                    reader.BeginObject();
                    reader.NextName();
                    reader.ReadFloat64();
                }
            }
        }

        private static JsonReader Reading(string text)
        {
            var reader = new JsonReader();
            Reset(reader, text);
            return reader;
        }

        private static void Reset(JsonReader reader, string text)
        {
            byte[] utf8 = Encoding.UTF8.GetBytes(text);
            reader.Reset(utf8, 0, utf8.Length);
        }
    }
}
