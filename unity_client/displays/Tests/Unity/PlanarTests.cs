// SPDX-License-Identifier: Apache-2.0
using System;
using NUnit.Framework;

namespace Ros2Gateway.Unity.Tests
{
    /// <summary>Yaw, heading, and poses on the floor.</summary>
    [TestFixture]
    public sealed class PlanarTests
    {
        private const double Rounding = 1e-12;

        [TestCase(0)]
        [TestCase(0.5)]
        [TestCase(Math.PI / 2)]
        [TestCase(3.1)]
        [TestCase(-3.1)]
        [TestCase(-1)]
        public void HeadingInUnityIsMinusTheYaw(double yaw)
        {
            Quaternion<Flu> orientation = Planar.FromYaw(yaw);
            Assert.AreEqual(yaw, orientation.Yaw(), Rounding);
            double heading = orientation.To<Ruf>().HeadingDegrees();
            Assert.AreEqual(-yaw * 180 / Math.PI, heading, 1e-10);
            Quaternion<Ruf> turned = orientation.To<Ruf>().Inverse * Planar.FromHeadingDegrees(heading);
            Assert.AreEqual(1, Math.Abs(turned.w), Rounding);
        }

        [Test]
        public void YawIsThatOfTheForwardAxisWhateverTheLengthAndTheSlope()
        {
            var slope = new Quaternion<Flu>(0, Math.Sin(0.1), 0, Math.Cos(0.1));
            Quaternion<Flu> onSlope = Planar.FromYaw(2) * slope;
            Assert.AreEqual(2, onSlope.Yaw(), Rounding);
            var longer = new Quaternion<Flu>(3 * onSlope.x, 3 * onSlope.y, 3 * onSlope.z, 3 * onSlope.w);
            Assert.AreEqual(2, longer.Yaw(), Rounding);
            Assert.AreEqual(0, default(Quaternion<Flu>).Yaw());
        }

        [Test]
        public void WrapKeepsTheDirection()
        {
            Assert.AreEqual(0.5, Planar.Wrap(0.5 + 4 * Math.PI), Rounding);
            Assert.AreEqual(-Math.PI + 0.1, Planar.Wrap(Math.PI + 0.1), Rounding);
            Assert.IsNaN(Planar.Wrap(double.PositiveInfinity));
        }

        [Test]
        public void PlanarPoseDropsWhatIsNotOnTheFloor()
        {
            var pose = new PlanarPose(new Pose<Flu>(new Vector3<Flu>(1, 2, 3), Planar.FromYaw(-0.7)));
            Assert.AreEqual(1, pose.x);
            Assert.AreEqual(2, pose.y);
            Assert.AreEqual(-0.7, pose.yaw, Rounding);
            Assert.IsTrue(pose.IsFinite);
            Assert.IsFalse(new PlanarPose(0, 0, double.NaN).IsFinite);
            Assert.IsFalse(new PlanarPose(double.NegativeInfinity, 0, 0).IsFinite);
            Assert.AreEqual(new Vector3<Flu>(1, 2, 0), pose.ToPose().position);
        }

        [Test]
        public void HeadingIsThatOfUnitysEuler()
        {
            UnityEngine.Quaternion unity = UnityEngine.Quaternion.Euler(0, 30, 0);
            Assert.AreEqual(30, unity.FromUnity<Ruf>().HeadingDegrees(), 1e-4);
            Assert.AreEqual(-Math.PI / 6, unity.FromUnity<Flu>().Yaw(), 1e-6);
        }
    }
}
