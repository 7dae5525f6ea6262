// SPDX-License-Identifier: Apache-2.0
using System;
using NUnit.Framework;

namespace Ros2Gateway.Tests
{
    /// <summary>A frame that the package does not have: cameras' optical one, right, down, forward.</summary>
    public struct Optical : IFrame
    {
        public bool IsLeftHanded => false;

        public void ToFlu(ref double x, ref double y, ref double z)
        {
            double right = x, down = y, forward = z;
            x = forward;
            y = -right;
            z = -down;
        }

        public void FromFlu(ref double x, ref double y, ref double z)
        {
            double forward = x, left = y, up = z;
            x = -left;
            y = -up;
            z = forward;
        }
    }

    [TestFixture]
    public class CoordinatesTests
    {
        private const double Exact = 0;
        private const double Rounding = 1e-12;

        private static readonly double Half = Math.Sqrt(0.5);

        [TestCase(1, 0, 0, 0, 0, 1)] // forward
        [TestCase(0, 1, 0, -1, 0, 0)] // left
        [TestCase(0, 0, 1, 0, 1, 0)] // up
        [TestCase(1, 2, 3, -2, 3, 1)]
        public void PositionsKeepTheirPlace(
            double x, double y, double z, double right, double up, double forward)
        {
            var ros = new Vector3<Flu>(x, y, z);
            var unity = new Vector3<Ruf>(right, up, forward);
            Assert.AreEqual(unity, ros.To<Ruf>());
            Assert.AreEqual(ros, unity.To<Flu>());
        }

        [TestCase(0, 0, 1, 0, -1, 0)] // counter-clockwise from above is against Unity's up
        [TestCase(0, 1, 0, 1, 0, 0)] // nose down
        [TestCase(1, 0, 0, 0, 0, -1)] // right side down
        [TestCase(1, 2, 3, 2, -3, -1)]
        public void AngularVelocitiesChangeTheirSense(
            double x, double y, double z, double a, double b, double c)
        {
            var ros = new AxialVector3<Flu>(x, y, z);
            var unity = new AxialVector3<Ruf>(a, b, c);
            Assert.AreEqual(unity, ros.To<Ruf>());
            Assert.AreEqual(ros, unity.To<Flu>());
        }

        [Test]
        public void QuaternionsOfKnownPosesConvert()
        {
            // A quarter turn to the left: Unity turns by -90 degrees about its y.
            AssertConverts(new Quaternion<Flu>(0, 0, Half, Half), new Quaternion<Ruf>(0, -Half, 0, Half));
            // Nose down by 90 degrees: Unity turns by +90 about its x.
            AssertConverts(new Quaternion<Flu>(0, Half, 0, Half), new Quaternion<Ruf>(Half, 0, 0, Half));
            // Right side down by 90 degrees: Unity turns by -90 about its z.
            AssertConverts(new Quaternion<Flu>(Half, 0, 0, Half), new Quaternion<Ruf>(0, 0, -Half, Half));
            AssertConverts(Quaternion<Flu>.Identity, Quaternion<Ruf>.Identity);
            AssertConverts(new Quaternion<Flu>(1, 2, 3, 4), new Quaternion<Ruf>(2, -3, -1, 4));
        }

        [Test]
        public void AnAircraftIsWhereItIsAndLooksWhereItLooks()
        {
            // 1 north, 2 east and 3 above the ground, with Unity's z to the north.
            Assert.AreEqual(new Vector3<Ruf>(2, 3, 1), new Vector3<Ned>(1, 2, -3).To<Ruf>());
            AssertConverts(Quaternion<Ned>.Identity, Quaternion<Ruf>.Identity);
            // To the east is a quarter turn about down, and in Unity about up by as much.
            AssertConverts(new Quaternion<Ned>(0, 0, Half, Half), new Quaternion<Ruf>(0, Half, 0, Half));
            // Nose up is about the right wing, and in Unity minus that.
            AssertConverts(new Quaternion<Ned>(0, Half, 0, Half), new Quaternion<Ruf>(-Half, 0, 0, Half));
            // Right wing down is about the nose, and in Unity minus that.
            AssertConverts(new Quaternion<Ned>(Half, 0, 0, Half), new Quaternion<Ruf>(0, 0, -Half, Half));
            // The rates of a turn to the right.
            Assert.AreEqual(new AxialVector3<Ruf>(0, 1, 0), new AxialVector3<Ned>(0, 0, 1).To<Ruf>());
        }

        [Test]
        public void AMapOfEastAndNorthIsTurnedToTheNorthByAQuarterTurn()
        {
            Quaternion<Ruf> turn = new(0, Math.Sqrt(0.5), 0, Math.Sqrt(0.5));
            AssertSame(new Vector3<Ruf>(1, 0, 0), turn * new Vector3<Flu>(1, 0, 0).To<Ruf>(), Rounding);
            AssertSame(new Vector3<Ruf>(0, 0, 1), turn * new Vector3<Flu>(0, 1, 0).To<Ruf>(), Rounding);
        }

        [Test]
        public void ThereAndBackIsExact()
        {
            var random = new Random(1);
            for (int i = 0; i < 200; i++)
            {
                Pose<Flu> pose = AnyPose<Flu>(random);
                Assert.AreEqual(pose, pose.To<Ruf>().To<Flu>());
                Assert.AreEqual(pose, pose.To<Optical>().To<Flu>());
                Assert.AreEqual(pose, pose.To<Ned>().To<Flu>());
                Assert.AreEqual(pose.To<Optical>(), pose.To<Ruf>().To<Optical>());
                Assert.AreEqual(pose, pose.To<Flu>());
            }
        }

        [Test]
        public void RotatingAndConvertingCommute()
        {
            AssertRotationCommutes<Flu, Ruf>();
            AssertRotationCommutes<Ruf, Flu>();
            AssertRotationCommutes<Flu, Optical>();
            AssertRotationCommutes<Optical, Flu>();
            AssertRotationCommutes<Ruf, Ned>();
            AssertRotationCommutes<Ned, Ruf>();
            AssertRotationCommutes<Ruf, Optical>();
            AssertRotationCommutes<Optical, Ruf>();
        }

        [Test]
        public void RotationMatricesConvertAsTheQuaternions()
        {
            AssertMatricesConvert<Flu, Ruf>();
            AssertMatricesConvert<Ruf, Flu>();
            AssertMatricesConvert<Flu, Optical>();
            AssertMatricesConvert<Optical, Ruf>();
        }

        [Test]
        public void ComposingAndConvertingCommute()
        {
            var random = new Random(2);
            for (int i = 0; i < 200; i++)
            {
                Pose<Flu> parent = AnyPose<Flu>(random);
                Pose<Flu> child = AnyPose<Flu>(random);
                Pose<Ruf> converted = parent.To<Ruf>() * child.To<Ruf>();
                AssertSame((parent * child).position.To<Ruf>(), converted.position, Rounding);
                AssertSame((parent * child).orientation.To<Ruf>(), converted.orientation, Rounding);
            }
        }

        [Test]
        public void TheVelocityOfAPointOnATurningBodyIsTheSameInBothFrames()
        {
            var random = new Random(3);
            for (int i = 0; i < 200; i++)
            {
                Vector3<Flu> arm = AnyVector<Flu>(random);
                Vector3<Flu> sense = AnyVector<Flu>(random);
                var turning = new AxialVector3<Flu>(sense.x, sense.y, sense.z);
                Vector3<Ruf> mirrored = Mirrored(turning.To<Ruf>(), arm.To<Ruf>());
                AssertSame(turning.Cross(arm).To<Ruf>(), mirrored, Rounding);
            }
        }

        [Test]
        public void InverseUndoesAPose()
        {
            var random = new Random(4);
            for (int i = 0; i < 50; i++)
            {
                Pose<Flu> pose = AnyPose<Flu>(random);
                Pose<Flu> nothing = pose.Inverse * pose;
                AssertSame(new Vector3<Flu>(0, 0, 0), nothing.position, Rounding);
                AssertSame(Quaternion<Flu>.Identity, nothing.orientation, Rounding);
            }
        }

        [Test]
        public void NormalizedIsIdentityForWhatIsNoRotation()
        {
            AssertSame(Quaternion<Flu>.Identity, default(Quaternion<Flu>).Normalized, Exact);
            AssertSame(Quaternion<Flu>.Identity, new Quaternion<Flu>(0, double.NaN, 0, 1).Normalized, Exact);
            var infinite = new Quaternion<Flu>(double.PositiveInfinity, 0, 0, 1);
            AssertSame(Quaternion<Flu>.Identity, infinite.Normalized, Exact);
            var longer = new Quaternion<Flu>(0, 0, 3, 4);
            AssertSame(new Quaternion<Flu>(0, 0, 0.6, 0.8), longer.Normalized, Rounding);
        }

        private static void AssertRotationCommutes<TFrom, TTo>()
            where TFrom : struct, IFrame
            where TTo : struct, IFrame
        {
            var random = new Random(5);
            for (int i = 0; i < 100; i++)
            {
                Quaternion<TFrom> rotation = AnyPose<TFrom>(random).orientation;
                Vector3<TFrom> vector = AnyVector<TFrom>(random);
                AssertSame((rotation * vector).To<TTo>(), rotation.To<TTo>() * vector.To<TTo>(), Rounding);
            }
        }

        // Independent of the product above: R' = C R C^-1, with C made of converted unit vectors and R by
        // the textbook's formula.
        private static void AssertMatricesConvert<TFrom, TTo>()
            where TFrom : struct, IFrame
            where TTo : struct, IFrame
        {
            double[,] change = Columns(
                new Vector3<TFrom>(1, 0, 0).To<TTo>(),
                new Vector3<TFrom>(0, 1, 0).To<TTo>(),
                new Vector3<TFrom>(0, 0, 1).To<TTo>());
            var random = new Random(6);
            for (int i = 0; i < 50; i++)
            {
                Quaternion<TFrom> rotation = AnyPose<TFrom>(random).orientation;
                double[,] expected = Product(Product(change, Matrix(rotation)), Transposed(change));
                double[,] actual = Matrix(rotation.To<TTo>());
                for (int row = 0; row < 3; row++)
                {
                    for (int column = 0; column < 3; column++)
                    {
                        Assert.AreEqual(expected[row, column], actual[row, column], Rounding);
                    }
                }
            }
        }

        // The components' cross product gives the velocity in a left-handed frame as well: both its axis and
        // its sense have changed sign there.
        private static Vector3<Ruf> Mirrored(AxialVector3<Ruf> turning, Vector3<Ruf> arm) => new Vector3<Ruf>(
            turning.y * arm.z - turning.z * arm.y,
            turning.z * arm.x - turning.x * arm.z,
            turning.x * arm.y - turning.y * arm.x);

        private static double[,] Columns<TFrame>(Vector3<TFrame> a, Vector3<TFrame> b, Vector3<TFrame> c)
            where TFrame : struct, IFrame =>
            new[,] { { a.x, b.x, c.x }, { a.y, b.y, c.y }, { a.z, b.z, c.z } };

        private static double[,] Matrix<TFrame>(Quaternion<TFrame> q)
            where TFrame : struct, IFrame =>
            new[,]
            {
                { 1 - 2 * (q.y * q.y + q.z * q.z), 2 * (q.x * q.y - q.z * q.w), 2 * (q.x * q.z + q.y * q.w) },
                { 2 * (q.x * q.y + q.z * q.w), 1 - 2 * (q.x * q.x + q.z * q.z), 2 * (q.y * q.z - q.x * q.w) },
                { 2 * (q.x * q.z - q.y * q.w), 2 * (q.y * q.z + q.x * q.w), 1 - 2 * (q.x * q.x + q.y * q.y) },
            };

        private static double[,] Product(double[,] left, double[,] right)
        {
            var product = new double[3, 3];
            for (int i = 0; i < 27; i++)
            {
                product[i / 9, i / 3 % 3] += left[i / 9, i % 3] * right[i % 3, i / 3 % 3];
            }
            return product;
        }

        private static double[,] Transposed(double[,] matrix)
        {
            var transposed = new double[3, 3];
            for (int i = 0; i < 9; i++)
            {
                transposed[i % 3, i / 3] = matrix[i / 3, i % 3];
            }
            return transposed;
        }

        private static Vector3<TFrame> AnyVector<TFrame>(Random random)
            where TFrame : struct, IFrame =>
            new Vector3<TFrame>(
                random.NextDouble() - 0.5, random.NextDouble() - 0.5, random.NextDouble() - 0.5);

        private static Pose<TFrame> AnyPose<TFrame>(Random random)
            where TFrame : struct, IFrame
        {
            Vector3<TFrame> axis = AnyVector<TFrame>(random);
            var orientation = new Quaternion<TFrame>(axis.x, axis.y, axis.z, random.NextDouble() - 0.5);
            return new Pose<TFrame>(AnyVector<TFrame>(random), orientation.Normalized);
        }

        private static void AssertConverts<TFrame>(Quaternion<TFrame> other, Quaternion<Ruf> unity)
            where TFrame : struct, IFrame
        {
            AssertSame(unity, other.To<Ruf>(), Exact);
            AssertSame(other, unity.To<TFrame>(), Exact);
        }

        private static void AssertSame<TFrame>(
            Vector3<TFrame> expected, Vector3<TFrame> actual, double tolerance)
            where TFrame : struct, IFrame =>
            Assert.IsTrue((expected - actual).Length <= tolerance, expected + " is not " + actual);

        private static void AssertSame<TFrame>(
            Quaternion<TFrame> expected, Quaternion<TFrame> actual, double tolerance)
            where TFrame : struct, IFrame
        {
            bool same = Math.Abs(expected.x - actual.x) <= tolerance
                && Math.Abs(expected.y - actual.y) <= tolerance
                && Math.Abs(expected.z - actual.z) <= tolerance
                && Math.Abs(expected.w - actual.w) <= tolerance;
            Assert.IsTrue(same, expected + " is not " + actual);
        }
    }
}
