// SPDX-License-Identifier: Apache-2.0
using NUnit.Framework;
using Ros2Gateway.Messages.GeometryMsgs;
using UnityEngine;

namespace Ros2Gateway.Unity.Tests
{
    [TestFixture]
    public class UnityCoordinatesTests
    {
        private const double Rounding = 1e-6; // UnityEngine counts in floats

        private static readonly double Half = System.Math.Sqrt(0.5);

        [Test]
        public void PositionsAndTurningConvert()
        {
            AssertSame(new Vector3(-2, 3, 1), new Vector3<Flu>(1, 2, 3).ToUnity());
            AssertSame(new Vector3(2, -3, -1), new AxialVector3<Flu>(1, 2, 3).ToUnity());
            Assert.AreEqual(new Vector3<Flu>(1, 2, 3), new Vector3(-2, 3, 1).FromUnity<Flu>());
            Assert.AreEqual(new AxialVector3<Flu>(1, 2, 3), new Vector3(2, -3, -1).FromUnityAxial<Flu>());
        }

        [TestCase(1, 0, 0)]
        [TestCase(0, 1, 0)]
        [TestCase(0, 0, 1)]
        [TestCase(0.3, -0.5, 0.7)]
        public void UnitysOwnRotationAgrees(double x, double y, double z)
        {
            var rotation = new Quaternion<Flu>(0.1, -0.2, 0.3, 0.9).Normalized;
            var vector = new Vector3<Flu>(x, y, z);
            AssertSame((rotation * vector).ToUnity(), rotation.ToUnity() * vector.ToUnity());
        }

        [Test]
        public void AQuarterTurnToTheLeftIsUnitysMinusNinety()
        {
            Quaternion unity = new Quaternion<Flu>(0, 0, Half, Half).ToUnity();
            AssertSame(new Vector3(-1, 0, 0), unity * Vector3.forward);
            AssertSame(Quaternion.Euler(0, -90, 0) * Vector3.forward, unity * Vector3.forward);
        }

        [Test]
        public void OrientationsThatAreNoneBecomeIdentity()
        {
            Quaternion unity = new QuaternionMsg { x = 0, y = 0, z = 0, w = 0 }.As<Flu>().ToUnity();
            Assert.AreEqual(1, unity.w);
            Assert.AreEqual(0, unity.x);
        }

        [Test]
        public void PosesGoThereAndBack()
        {
            var pose = new Pose<Flu>(new Vector3<Flu>(1, 2, 3), new Quaternion<Flu>(0, 0, Half, Half));
            Pose<Flu> back = pose.ToUnity().FromUnity<Flu>();
            Assert.AreEqual(0, (back.position - pose.position).Length, Rounding);
            Assert.AreEqual(1, System.Math.Abs((pose.orientation.Inverse * back.orientation).w), Rounding);
        }

        private static void AssertSame(Vector3 expected, Vector3 actual)
        {
            Assert.AreEqual(expected.x, actual.x, Rounding);
            Assert.AreEqual(expected.y, actual.y, Rounding);
            Assert.AreEqual(expected.z, actual.z, Rounding);
        }
    }
}
