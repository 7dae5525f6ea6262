// SPDX-License-Identifier: Apache-2.0
using System.Text;
using NUnit.Framework;
using Ros2Gateway.Json;

namespace Ros2Gateway.Tests
{
    [TestFixture]
    public class JsonWriterTests
    {
        [Test]
        public void CommasComeByThemselves()
        {
            var writer = new JsonWriter();
            writer.BeginObject();
            writer.Name("a");
            writer.BeginArray();
            writer.Value(1);
            writer.BeginObject();
            writer.EndObject();
            writer.Value("x");
            writer.EndArray();
            writer.Name("b");
            writer.Value(true);
            writer.Name("c");
            writer.Null();
            writer.EndObject();
            Assert.AreEqual("{\"a\":[1,{},\"x\"],\"b\":true,\"c\":null}", writer.ToString());
        }

        [Test]
        public void AWriterBeginsAnewWhenCleared()
        {
            var writer = new JsonWriter();
            writer.Value(new string('x', 3000000));
            writer.Clear();
            writer.Value(1);
            Assert.AreEqual("1", writer.ToString());
            Assert.Less(writer.Buffer.Length, 2000000, "a huge message is not paid for ever after");
        }

        [TestCase(0.0, "0.0")]
        [TestCase(-0.0, "-0.0")]
        [TestCase(1.0, "1.0")]
        [TestCase(0.1, "0.1")]
        [TestCase(-1.82, "-1.82")]
        [TestCase(100.0, "100.0")]
        [TestCase(123456.789, "123456.789")]
        [TestCase(0.00001, "0.00001")]
        [TestCase(0.000001, "0.000001")]
        [TestCase(1.5e-7, "0.00000015")]
        [TestCase(1e15, "1000000000000000.0")]
        [TestCase(1e16, "10000000000000000.0")]
        [TestCase(double.Epsilon, "4.9406564584124654E-324")]
        [TestCase(double.MaxValue, "1.7976931348623157E+308")]
        [TestCase(double.NaN, "null")]
        [TestCase(double.PositiveInfinity, "\"Infinity\"")]
        [TestCase(double.NegativeInfinity, "\"-Infinity\"")]
        public void ADoubleIsWrittenForEveryBit(double value, string expected)
        {
            var writer = new JsonWriter();
            writer.Value(value);
            Assert.AreEqual(expected, writer.ToString());
        }

        [TestCase(0.1f, "0.1")]
        [TestCase(16777216f, "16777216.0")]
        [TestCase(float.Epsilon, "1.40129846E-45")]
        [TestCase(float.MaxValue, "3.40282347E+38")]
        [TestCase(float.NaN, "null")]
        [TestCase(float.NegativeInfinity, "\"-Infinity\"")]
        [TestCase(float.PositiveInfinity, "\"Infinity\"")]
        public void AFloatIsWrittenForEveryBit(float value, string expected)
        {
            var writer = new JsonWriter();
            writer.Value(value);
            Assert.AreEqual(expected, writer.ToString());
        }

        [Test]
        public void IntegersKeepAllTheirDigits()
        {
            var writer = new JsonWriter();
            writer.BeginArray();
            writer.Value(long.MinValue);
            writer.Value(long.MaxValue);
            writer.Value(ulong.MaxValue);
            writer.Value(sbyte.MinValue);
            writer.EndArray();
            Assert.AreEqual(
                "[-9223372036854775808,9223372036854775807,18446744073709551615,-128]", writer.ToString());
        }

        [Test]
        public void WhatJsonForbidsInTextsIsEscaped()
        {
            var writer = new JsonWriter();
            writer.Value("\"\\\u0000\u001f\n\r\t/\u007f\u00fc\ud83e\udd16");
            Assert.AreEqual(
                "\"\\\"\\\\\\u0000\\u001f\\n\\r\\t/\u007f\u00fc\ud83e\udd16\"", writer.ToString());
        }

        [TestCase(0xD83E)]
        [TestCase(0xDD16)]
        public void HalfOfASurrogatePairIsReplaced(int half)
        {
            var writer = new JsonWriter();
            writer.Value("a" + (char)half + "b" + (char)half);
            Assert.AreEqual("\"a\ufffdb\ufffd\"", writer.ToString());
        }

        [TestCase("\u0001")]
        [TestCase("\u00fc")]
        [TestCase("\u20ac")]
        [TestCase("\ud83e\udd16")]
        public void TheBufferGrowsWithCharactersOfSeveralBytes(string character)
        {
            for (int length = 1; length < 600; length++)
            {
                string text = new StringBuilder().Insert(0, character, length).ToString();
                var writer = new JsonWriter();
                writer.Value(text);
                Assert.AreEqual(text, JsonValue.Parse(writer.ToString()).AsString());
            }
        }

        [Test]
        public void NullTextsAndArraysAreEmpty()
        {
            var writer = new JsonWriter();
            writer.BeginArray();
            writer.Value((string)null);
            writer.Values((double[])null);
            writer.Base64(null);
            writer.EndArray();
            Assert.AreEqual("[\"\",[],\"\"]", writer.ToString());
        }

        [TestCase("", "")]
        [TestCase("f", "Zg==")]
        [TestCase("fo", "Zm8=")]
        [TestCase("foo", "Zm9v")]
        [TestCase("foob", "Zm9vYg==")]
        public void OctetsAreWrittenAsBase64(string octets, string expected)
        {
            var writer = new JsonWriter();
            writer.Base64(Encoding.ASCII.GetBytes(octets));
            Assert.AreEqual("\"" + expected + "\"", writer.ToString());
        }

        [Test]
        public void RawJsonIsTakenAsItIs()
        {
            byte[] raw = Encoding.ASCII.GetBytes("xx{\"a\":1}xx");
            var writer = new JsonWriter();
            writer.BeginArray();
            writer.Value(0);
            writer.Raw(raw, 2, raw.Length - 4);
            writer.Value(2);
            writer.EndArray();
            Assert.AreEqual("[0,{\"a\":1},2]", writer.ToString());
        }
    }
}
