// SPDX-License-Identifier: Apache-2.0
using NUnit.Framework;
using Ros2Gateway.Pictures;

namespace Ros2Gateway.Tests
{
    [TestFixture]
    public sealed class PictureBoundTests
    {
        [TestCase(0, 100, 160)]
        [TestCase(0, 128, 160)]
        [TestCase(0, 129, 240)]
        [TestCase(0, 3072, 3840)]
        [TestCase(0, 3073, 0)]
        [TestCase(0, double.PositiveInfinity, 0)]
        [TestCase(640, 640, 640)]
        [TestCase(640, 641, 960)]
        [TestCase(640, 3841, 0)]
        [TestCase(640, double.PositiveInfinity, 0)]
        [TestCase(640, 385, 640)]
        [TestCase(640, 384, 480)]
        [TestCase(640, 0, 160)]
        [TestCase(160, 0, 160)]
        [TestCase(640, double.NaN, 640)]
        [TestCase(0, double.NaN, 0)]
        public void ItGrowsAtOnceAndShrinksWithASpare(int asked, double pixels, int expected) =>
            Assert.AreEqual(expected, PictureBound.Next(asked, pixels));

        [Test]
        public void WhatIsAskedForOnceStaysForThatManyPixels([Values(1, 150, 200, 500, 1000, 3000, 5000)] double pixels)
        {
            foreach (int asked in new[] { 0, 160, 640, 3840 })
            {
                int next = PictureBound.Next(asked, pixels);
                Assert.AreEqual(next, PictureBound.Next(next, pixels));
            }
        }
    }
}
