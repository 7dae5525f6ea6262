// SPDX-License-Identifier: Apache-2.0
using NUnit.Framework;
using Ros2Gateway.Json;

namespace Ros2Gateway.Tests
{
    [TestFixture]
    public class JsonValueTests
    {
        [Test]
        public void WhatIsNotThereIsMissingAtAnyDepth()
        {
            JsonValue value = JsonValue.Parse("{\"a\":[1]}");
            Assert.IsFalse(value["b"]["c"][3].Exists);
            Assert.AreSame(JsonValue.Missing, value["a"][1]);
            Assert.AreSame(JsonValue.Missing, value["a"][-1]);
            Assert.AreSame(JsonValue.Missing, value[(string)null]);
            Assert.AreEqual(JsonKind.End, JsonValue.Missing.Kind);
            Assert.AreEqual("x", value["b"].AsString("x"));
            Assert.AreEqual(1, value["a"][0].AsLong());
        }

        [Test]
        public void AValueOfAnotherKindGivesTheFallback()
        {
            JsonValue value = JsonValue.Parse("[\"1\",1.5,null,true,-1]");
            Assert.AreEqual(7, value[0].AsLong(7));
            Assert.AreEqual(7, value[1].AsLong(7));
            Assert.IsTrue(double.IsNaN(value[2].AsDouble(7)));
            Assert.AreEqual("7", value[3].AsString("7"));
            Assert.AreEqual(7, value[4].AsULong(7));
            Assert.IsTrue(value[4].AsBool(true));
        }

        [Test]
        public void InfinitiesAreTextsOfTheirNames()
        {
            JsonValue value = JsonValue.Array(double.PositiveInfinity, double.NegativeInfinity, double.NaN);
            Assert.AreEqual("[\"Infinity\",\"-Infinity\",null]", value.ToString());
            Assert.AreEqual(double.PositiveInfinity, value[0].AsDouble());
            Assert.AreEqual(double.NegativeInfinity, value[1].AsDouble());
            Assert.IsNaN(JsonValue.Parse("\"NaN\"").AsDouble(7));
            Assert.AreEqual(7, JsonValue.Parse("\"inf\"").AsDouble(7));
        }

        [Test]
        public void IntegersKeepAllTheirDigits()
        {
            const string Text = "[9223372036854775807,-9223372036854775808,18446744073709551615,1.0]";
            JsonValue value = JsonValue.Parse(Text);
            Assert.AreEqual(long.MaxValue, value[0].AsLong());
            Assert.AreEqual(long.MinValue, value[1].AsLong());
            Assert.AreEqual(ulong.MaxValue, value[2].AsULong());
            Assert.AreEqual(1, value[3].AsLong());
            Assert.AreEqual(Text, value.ToString());
        }

        [Test]
        public void OfTwoMembersOfOneNameTheLastWins()
        {
            JsonValue value = JsonValue.Parse("{\"a\":1,\"b\":2,\"a\":3}");
            Assert.AreEqual("{\"a\":3,\"b\":2}", value.ToString());
            CollectionAssert.AreEqual(new[] { "a", "b" }, value.Names);
        }

        [Test]
        public void ValuesAreMadeOfWhatTheyHold()
        {
            JsonValue value = JsonValue.Object()
                .With("text", "x")
                .With("number", 1.5)
                .With("array", JsonValue.Array(1, true, null, double.NaN, 2UL))
                .With("number", -2);
            Assert.AreEqual(
                "{\"text\":\"x\",\"number\":-2,\"array\":[1,true,null,null,2]}", value.ToString());
            Assert.AreEqual(3, value.Count);
            Assert.AreEqual(5, value["array"].Items.Count);
        }

        [Test]
        public void AChangedCopyLeavesTheOriginalAsItWas()
        {
            JsonValue original = JsonValue.Object().With("a", 1);
            JsonValue copy = original.With("b", 2);
            Assert.AreEqual("{\"a\":1}", original.ToString());
            Assert.AreEqual("{\"a\":1,\"b\":2}", copy.ToString());
        }

        [TestCase("")]
        [TestCase("{")]
        [TestCase("[1] 2")]
        [TestCase("1e400")]
        public void WhatIsNoJsonIsRefused(string text) => Assert.Throws<JsonFormatException>(() => JsonValue.Parse(text));

        [Test]
        public void HalfOfASurrogatePairIsNoText()
        {
            Assert.Throws<JsonFormatException>(() => JsonValue.Parse("\"\ud83e\""));
            Assert.Throws<JsonFormatException>(() => JsonValue.Parse("\"\\ud83e\""));
        }
    }
}
