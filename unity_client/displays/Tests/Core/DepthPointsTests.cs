// SPDX-License-Identifier: Apache-2.0
using System;
using NUnit.Framework;
using Ros2Gateway.Messages.SensorMsgs;
using Ros2Gateway.Pictures;

namespace Ros2Gateway.Tests
{
    [TestFixture]
    [Category("Inflates")]
    public sealed class DepthPointsTests
    {
        // 2 by 2 pixels of 16 bits: 0, 1000, 2000 and 65535 mm
        private const string Picture =
            "iVBORw0KGgoAAAANSUhEUgAAAAIAAAACEAAAAAAHTY67AAAAEklEQVR42mNgYGB+wcB+4f9/AAsYA8HJfpDrAAAAAElFTkSuQmCC";

        private const double Tolerance = 1e-9;

        [Test]
        public void PixelsArePointsOfTheOpticalFrame()
        {
            DepthPoints points = new(Math.PI / 2); // at 1 m it sees 2 m
            Assert.IsNull(points.Read(Convert.FromBase64String(Picture)));
            Assert.IsFalse(points.TryGet(0, 0, out Vector3<Flu> point), "nothing was measured");
            Assert.IsTrue(points.TryGet(1, 0, out point));
            Is(0.5, -0.5, 1, point);
            Assert.IsTrue(points.TryGet(0, 1, out point));
            Is(-1, 1, 2, point);
            Assert.IsTrue(points.TryGet(1, 1, out point));
            Assert.AreEqual(65.535, point.z, Tolerance);
        }

        [Test]
        public void ACameraThatSaysWhatItIsIsBelievedAtAnySize()
        {
            DepthPoints points = new(1);
            Assert.IsNull(points.View(new CameraInfoMsg
            {
                width = 640, height = 480, k = new double[] { 320, 0, 480, 0, 240, 120, 0, 0, 1 },
            }));
            points.Read(Convert.FromBase64String(Picture));
            points.TryGet(1, 0, out Vector3<Flu> point);
            Is(0, 0, 1, point);
        }

        [Test]
        public void WhatIsNoDepthIsSaid()
        {
            DepthPoints points = new(double.NaN);
            StringAssert.Contains("not calibrated", points.View(new CameraInfoMsg { width = 1, height = 1 }));
            StringAssert.Contains("not calibrated", points.View(new CameraInfoMsg { k = null }));
            StringAssert.Contains("not a PNG", points.Read(null));
            StringAssert.Contains("8 bits", points.Read(Convert.FromBase64String(
                "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR42mNgBAAAAwAC5n2nZwAAAABJRU5ErkJggg==")));
        }

        private static void Is(double x, double y, double z, Vector3<Flu> point)
        {
            Assert.AreEqual(x, point.x, Tolerance);
            Assert.AreEqual(y, point.y, Tolerance);
            Assert.AreEqual(z, point.z, Tolerance);
        }
    }
}
