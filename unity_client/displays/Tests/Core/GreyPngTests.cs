// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using NUnit.Framework;
using Ros2Gateway.Pictures;

namespace Ros2Gateway.Tests
{
    /// <summary>Pictures that zlib compressed, in each of the ways that it has.</summary>
    [TestFixture]
    [Category("Inflates")]
    public sealed class GreyPngTests
    {
        // 7 by 10 pixels, the rows with each of the five filters twice
        private const string Filtered =
            "iVBORw0KGgoAAAANSUhEUgAAAAcAAAAKCAAAAABdpxvRAAAAT0lEQVR42mNhkI+dfVM8lJlZyevjTIcMJmYRVTP3iExGzqAJ53i8"
            + "Ohh48gXe86QzsEDEmZi5fb/IOGdPgquTWP5UOXH+XQbpyyf/5svzAgBc/Rc4SLTEuwAAAABJRU5ErkJggg==";

        // the same of 16 bits, its stream in four chunks
        private const string Sixteen =
            "iVBORw0KGgoAAAANSUhEUgAAAAcAAAAKEAAAAAANN8eSAAAAKElEQVR42mNgYOCRMSjI+XPwgN6ezR9YGHXYL/Jzil2XqVTeqjWP"
            + "mclJ0ERBbMsq8gAAAChJREFUy0DRXvx8X1wLI3OLgrVlccDqzMeN0rOCmRh1OB7yTRPzlmFQ3qqZxZai3EIAAAAoSURBVMB6x7ix"
            + "Mu56se+BO67NTCxMOhxRfNNET8kwKG3VLGJmNVD6YfjeMTVOVwixAAAAIElEQVQgJuFSvicjZ4LTkag/RSZdOYuX7L4DNUoUahQA"
            + "Qrkx4DiBPkEAAAAASUVORK5CYII=";

        // not compressed
        private const string Stored =
            "iVBORw0KGgoAAAANSUhEUgAAAAcAAAAKCAAAAABdpxvRAAAAW0lEQVR4AQFQAK//AAAffBfwB1wAAzOhTTdfxQAGR8aDfrcuAAlb"
            + "67nFD5cADG8Q7wxnAAAPgzUlU79pABKXWluaF9IAFat/keFvOwAYv6THKMekABvTyf1vHw0biBylUYEyMQAAAABJRU5ErkJggg==";

        // 30 by 20 pixels, by the code that the format itself defines
        private const string FixedCode =
            "iVBORw0KGgoAAAANSUhEUgAAAB4AAAAUCAAAAAC/wNIYAAAAsklEQVR4AWNggANGOGCCAwZ2OOCAA044YOCDA344EIADBlE4EIMD"
            + "cThgkIEDWTiQgwMGZThQgQNVOGDQggNtONCBAwZDODCCA2M4YLCAA0s4sIIDBns4cIADRzhgcIMDdzjwgAMGXzjwgwN/OGAIgYNQ"
            + "OAiDA4ZoOIiBg1g4YEiCg2Q4SIEDhkw4yIKDbDhgKICDQjgoggOGcjiogINKOGCog4N6OGiAA4ZWOGiDg3Y4AAB+WZ4160XeKQAA"
            + "AABJRU5ErkJggg==";

        // 64 by 32 pixels, by a code of up to 12 bits
        private const string LongCodes =
            "iVBORw0KGgoAAAANSUhEUgAAAEAAAAAgCAAAAACH9iFYAAACQElEQVR4AQXBEaIlCxZFwbSwZduOpaVde1b2rec/nY54HpmcTF6Z"
            + "nEw+mZxMXpmcTJ6fTE4mr0xOJp9MTiavTE4mz59MTiavTE4mn0xOJq9MTibPTyYnk1cmJ5NPJieTVyYnk+efTE4mr0xOJp9MTiav"
            + "TE4mz08mJ5NXJieTTyYnk1cmJ5PnTyYnk1cmJ5NPJieTVyYnk+cnk5PJK5OTySeTk8krk5PJ859MTiavTE4mn0xOJq9MTibPTyYn"
            + "k1cmJ5NPJieTVyYnk+dPJieTVyYnk08mJ5NXJieT5yeTk8krk5PJJ5OTySuTk8nzTyYnk1cmJ5NPJieTVyYnk+cnk5PJK5OTySeT"
            + "k8krk5PJ8yeTk8krk5PJJ5OTySuTk8nzk8nJ5JXJyeSTycnklcnJ5PmfTE4mr0xOJp9MTiavTE4mz08mJ5NXJieTTyYnk1cmJ5Pn"
            + "TyYnk1cmJ5NPJieTVyYnk+cnk5PJK5OTySeTk8krk5PJ808mJ5NXJieTTyYnk1cmJ5PnJ5OTySuTk8knk5PJK5OTyfMnk5PJK5OT"
            + "ySeTk8krk5PJ85PJyeSVycnkk8nJ5JXJyeT5TyYnk1cmJ5NPJieTVyYnk+cnk5PJK5OTySeTk8krk5PJ8yeTk8krk5PJJ5OTySuT"
            + "k8nzk8nJ5JXJyeSTycnklcnJ5Pknk5PJK5OTySeTk8krk5PJ85PJyeSVycnkk8nJ5JXJyeT5k8nJ5JXJyeSTycnklcnJ5PnJ5GTy"
            + "yuRk8snkZPLK5GTyf3XWb6btvJCsAAAAAElFTkSuQmCC";

        [TestCase(Filtered)]
        [TestCase(Stored)]
        public void PixelsAreThoseThatWereCompressed(string picture)
        {
            GreyPng png = Read(picture, 7, 10, 1);
            for (int y = 0; y < 10; y++)
            {
                for (int x = 0; x < 7; x++)
                {
                    Assert.AreEqual((x * x * 31 + y * 17 * x + y * 3) % 256, png.Pixels[y * 7 + x], x + ", " + y);
                }
            }
        }

        [Test]
        public void SixteenBitsComeWhole()
        {
            GreyPng png = Read(Sixteen, 7, 10, 2);
            for (int y = 0; y < 10; y++)
            {
                for (int x = 0; x < 7; x++)
                {
                    int at = 2 * (y * 7 + x);
                    int value = png.Pixels[at] << 8 | png.Pixels[at + 1];
                    Assert.AreEqual((x * x * 3100 + y * 1717 * x + y * 300) % 65536, value, x + ", " + y);
                }
            }
        }

        [Test]
        public void TheFormatsOwnCodeIsKnown()
        {
            GreyPng png = Read(FixedCode, 30, 20, 1);
            for (int i = 0; i < 600; i++)
            {
                Assert.AreEqual(7 * (i / 30) + i % 30 / 10, png.Pixels[i], "pixel " + i);
            }
        }

        [Test]
        public void CodesLongerThanTheTableAreFound()
        {
            GreyPng png = Read(LongCodes, 64, 32, 1);
            for (int i = 0; i < 2048; i++)
            {
                int bit = 0;
                while (i > 0 && (i >> bit & 1) == 0)
                {
                    bit++;
                }
                Assert.AreEqual(i == 0 ? 0 : 7 * (bit + 1), png.Pixels[i], "pixel " + i);
            }
        }

        [Test]
        public void AReaderIsUsedAgain()
        {
            GreyPng png = new(1);
            Assert.IsNull(png.Read(Convert.FromBase64String(LongCodes)));
            Assert.IsNull(png.Read(Convert.FromBase64String(Filtered)));
            Assert.AreEqual(7, png.Width);
            Assert.AreEqual(31, png.Pixels[1]);
        }

        [Test]
        public void DamageIsWordsNeverAnException()
        {
            Random random = new(4);
            int refused = 0;
            foreach (string picture in new[] { Filtered, Sixteen, Stored, FixedCode, LongCodes })
            {
                byte[] whole = Convert.FromBase64String(picture);
                GreyPng png = new(picture == Sixteen ? 2 : 1);
                for (int i = 0; i < 500; i++)
                {
                    byte[] damaged = (byte[])whole.Clone();
                    for (int bytes = random.Next(1, 4); bytes > 0; bytes--)
                    {
                        damaged[random.Next(damaged.Length)] = (byte)random.Next(256);
                    }
                    if (random.Next(3) == 0)
                    {
                        Array.Resize(ref damaged, random.Next(damaged.Length));
                    }
                    refused += png.Read(damaged) == null ? 0 : 1;
                }
            }
            Assert.Greater(refused, 1000);
        }

        [Test]
        public void WhatIsNoGreyPictureIsToldFromADamagedOne()
        {
            GreyPng png = new(1);
            StringAssert.Contains("it is not a PNG", png.Read(null));
            StringAssert.Contains("it is not a PNG", png.Read(new byte[100]));
            byte[] colored = Convert.FromBase64String(Filtered);
            colored[25] = 2;
            StringAssert.Contains("not a gray PNG", png.Read(colored));
        }

        [TestCase(Filtered, 1, "at most 67108864")]
        [TestCase(Sixteen, 2, "at most 16777216")]
        public void SizesAreBounded(string picture, int bytes, string bound)
        {
            byte[] huge = Convert.FromBase64String(picture);
            huge[16] = 1; // 16 million pixels wide
            StringAssert.Contains(bound, new GreyPng(bytes).Read(huge));
        }

        [Test]
        public void ALargeMapIsRead()
        {
            GreyPng png = new(1);
            Assert.IsNull(png.Read(Blank(5000, 5001)));
            Assert.AreEqual(5000, png.Width);
            Assert.AreEqual(5001, png.Height);
            Assert.AreEqual(-1, Array.FindIndex(png.Pixels, 0, 5000 * 5001, pixel => pixel != 0));
        }

        [Test]
        public void ThereIsNoRoomForWhatAFewBytesOnlyClaim()
        {
            byte[] picture = Blank(64, 64);
            picture[18] = picture[22] = 16; // 4160 by 4160 pixels
            GreyPng png = new(1);
            StringAssert.Contains("4160 by 4160 pixels, more than ", png.Read(picture));
            Assert.IsNull(png.Pixels);
        }

        [TestCase(Sixteen, 1, "16 bits a pixel, must have 8")]
        [TestCase(Filtered, 2, "8 bits a pixel, must have 16")]
        public void TheOtherDepthIsRefusedBeforeItIsDecoded(string picture, int bytes, string words)
        {
            GreyPng png = new(bytes);
            StringAssert.Contains(words, png.Read(Convert.FromBase64String(picture)));
            Assert.IsNull(png.Pixels);
            Assert.Throws<ArgumentOutOfRangeException>(() => new GreyPng(bytes + 2));
        }

        /// <summary>A picture of zeros, by the code that the format itself defines: a 158th of its pixels.</summary>
        private static byte[] Blank(int width, int height)
        {
            int zeros = height * (width + 1);
            List<byte> stream = new() { 0x78, 0x01 };
            int bits = 0;
            Action<int, int> put = (value, count) => // the lowest bit first
            {
                for (int i = 0; i < count; i++, bits++)
                {
                    if (bits % 8 == 0)
                    {
                        stream.Add(0);
                    }
                    stream[stream.Count - 1] |= (byte)((value >> i & 1) << bits % 8);
                }
            };
            put(3, 3); // the last block, of that code
            for (int literals = 1 + (zeros - 1) % 258; literals > 0; literals--)
            {
                put(0x0C, 8); // codes come with the highest bit first
            }
            for (int repetitions = (zeros - 1) / 258; repetitions > 0; repetitions--)
            {
                put(0xA3, 8); // 258 times
                put(0, 5); // the byte before
            }
            put(0, 7);
            List<byte> png = new() { 137, 80, 78, 71, 13, 10, 26, 10 };
            Chunk(png, "IHDR", new byte[]
            {
                0, 0, (byte)(width >> 8), (byte)width, 0, 0, (byte)(height >> 8), (byte)height, 8, 0, 0, 0, 0,
            });
            Chunk(png, "IDAT", stream.ToArray());
            return png.ToArray();
        }

        private static void Chunk(List<byte> png, string name, byte[] content)
        {
            for (int shift = 24; shift >= 0; shift -= 8)
            {
                png.Add((byte)(content.Length >> shift));
            }
            png.AddRange(System.Text.Encoding.ASCII.GetBytes(name));
            png.AddRange(content);
            png.AddRange(new byte[4]); // a checksum, which nobody looks at
        }

        private static GreyPng Read(string picture, int width, int height, int bytes)
        {
            GreyPng png = new(bytes);
            Assert.IsNull(png.Read(Convert.FromBase64String(picture)));
            Assert.AreEqual(width, png.Width);
            Assert.AreEqual(height, png.Height);
            return png;
        }
    }
}
