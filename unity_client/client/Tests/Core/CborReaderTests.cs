// SPDX-License-Identifier: Apache-2.0
using System;
using NUnit.Framework;
using Ros2Gateway.Json;

namespace Ros2Gateway.Tests
{
    /// <summary>Frames that no gateway sends, and that the reader refuses in words.</summary>
    [TestFixture]
    public sealed class CborReaderTests
    {
        // A typed array of octets (tag 64) whose octets would be heads of a text, an array, true, octets.
        private static readonly byte[] Octets = { 0xD8, 64, 0x44, 0x61, 0x81, 0xF5, 0x41 };

        [TestCase(0, "a string")]
        [TestCase(1, "an array")]
        [TestCase(2, "true or false")]
        [TestCase(3, "octets")]
        [TestCase(3, "octets, into a buffer")]
        [TestCase(0, "an object")]
        public void ElementsOfATypedArrayAreNumbersAndNothingElse(int index, string expected)
        {
            CborReader reader = new();
            reader.Reset(Octets, 0, Octets.Length);
            reader.BeginArray();
            for (int i = 0; i < index; i++)
            {
                Assert.IsTrue(reader.NextElement());
                reader.Skip();
            }
            Assert.IsTrue(reader.NextElement());
            string words = Assert.Throws<JsonFormatException>(() => Read(reader, expected)).Message;
            StringAssert.Contains("expected " + expected.Split(',')[0] + ", got a number", words);
            StringAssert.Contains("[" + index + "]", words);
            Assert.AreEqual(Octets[3 + index], reader.ReadFloat64(), "it stays where it was");
        }

        private static void Read(CborReader reader, string what)
        {
            byte[] buffer = Array.Empty<byte>();
            switch (what)
            {
                case "a string":
                    reader.ReadString();
                    break;
                case "an array":
                    reader.BeginArray();
                    break;
                case "true or false":
                    reader.ReadBool();
                    break;
                case "octets":
                    reader.ReadBytes(null);
                    break;
                case "octets, into a buffer":
                    reader.ReadBytes(ref buffer);
                    break;
                default:
                    reader.BeginObject();
                    break;
            }
        }
    }
}
