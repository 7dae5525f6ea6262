// SPDX-License-Identifier: Apache-2.0
using System;
using NUnit.Framework;
using Ros2Gateway.Drive;

namespace Ros2Gateway.Tests
{
    [TestFixture]
    public class PidTests
    {
        [Test]
        public void TheProportionalPartFollowsTheErrorUpToTheLimit()
        {
            var pid = new Pid(new PidGains(2, 0, 0), 1);
            Assert.AreEqual(0.5, pid.Step(0.25, 0));
            Assert.AreEqual(-0.5, pid.Step(-0.25, 0.1));
            Assert.AreEqual(1, pid.Step(5, 0.2));
            Assert.AreEqual(-1, pid.Step(double.MinValue, 0.3));
        }

        [Test]
        public void TheIntegralPartGrowsWithErrorAndTime()
        {
            var pid = new Pid(new PidGains(0, 2, 0), 10);
            Assert.AreEqual(0, pid.Step(3, 0));
            Assert.AreEqual(0.6, pid.Step(3, 0.1), 1e-12);
            Assert.AreEqual(1.8, pid.Step(3, 0.3), 1e-12);
        }

        [Test]
        public void TheDerivativePartSettlesAtTheErrorsSlope()
        {
            var pid = new Pid(new PidGains(0, 0, 2), 10);
            double output = 0;
            for (int i = 0; i <= 100; i++)
            {
                output = pid.Step(-0.5 * i * 0.02, i * 0.02);
            }
            Assert.AreEqual(-1, output, 1e-6);
        }

        [Test]
        public void AMinuteAtTheLimitIsForgottenAsSoonAsTheErrorTurns()
        {
            var pid = new Pid(new PidGains(1, 1, 0), 1);
            double now = 0;
            for (; now < 60; now += 0.1)
            {
                Assert.AreEqual(1, pid.Step(2, now), 1e-9);
            }
            Assert.LessOrEqual(pid.Step(-0.5, now), 0.5);
            Assert.Less(pid.Step(-1.0, now + 0.1), 0.01);
        }

        [Test]
        public void TheIntegralAloneNeverExceedsTheLimit()
        {
            var pid = new Pid(new PidGains(0, 1, 1), 1);
            // The derivative holds the sum below the limit while the integral grows.
            for (int i = 0; i <= 100; i++)
            {
                pid.Step(10 - 0.05 * i, 0.05 * i);
            }
            double output = 0;
            for (int i = 101; i <= 130; i++)
            {
                output = pid.Step(-0.5, 0.05 * i);
            }
            Assert.Less(output, 1 - 0.5);
        }

        [Test]
        public void ALaggingPlantSettlesWithoutOffset()
        {
            var pid = new Pid(new PidGains(2, 1, 0.1), 5);
            double position = 0, speed = 0;
            for (int i = 0; i < 3000; i++)
            {
                double push = pid.Step(1 - position, i * 0.01) - 0.5; // a constant load
                speed += (push - speed) * 0.05;
                position += speed * 0.01;
            }
            Assert.AreEqual(1, position, 1e-3);
        }

        [Test]
        public void ResetLeavesNothingOfThePast()
        {
            var pid = new Pid(new PidGains(1, 1, 1), 10);
            for (int i = 0; i < 20; i++)
            {
                pid.Step(i, i * 0.1);
            }
            pid.Reset();
            Assert.AreEqual(0.5, pid.Step(0.5, 2));
        }

        [TestCase(-5.0)]
        [TestCase(60.0)]
        public void AClockThatJumpsForgetsThePast(double jump)
        {
            var pid = new Pid(new PidGains(1, 1, 1), 10);
            pid.Step(0, 100);
            pid.Step(1, 100.1);
            Assert.AreEqual(0.5, pid.Step(0.5, 100 + jump));
        }

        [Test]
        public void AClockThatStandsStillChangesNothing()
        {
            var pid = new Pid(new PidGains(1, 1, 1), 10);
            pid.Step(1, 0);
            double output = pid.Step(1, 0.1);
            Assert.AreEqual(output, pid.Step(1, 0.1));
        }

        [TestCase(double.NaN, 0)]
        [TestCase(double.PositiveInfinity, 0)]
        [TestCase(1, double.NaN)]
        public void WhatIsNotFiniteGivesZeroAndDoesNoHarm(double error, double now)
        {
            var pid = new Pid(new PidGains(1, 1, 1), 10);
            pid.Step(1, 0);
            Assert.AreEqual(0, pid.Step(error, now));
            Assert.AreEqual(0.5, pid.Step(0.5, 0.1));
        }

        [Test]
        public void HugeErrorsDoNotStayInTheMemory()
        {
            var pid = new Pid(new PidGains(1, 1, 1), 10);
            pid.Step(double.MaxValue, 0);
            pid.Step(double.MinValue, 0.01);
            pid.Step(0, 0.02);
            for (int i = 3; i < 500; i++)
            {
                pid.Step(0, i * 0.01);
            }
            Assert.AreEqual(3, pid.Step(3, 5 + 10), 1e-9);
        }

        [Test]
        public void GainsAndLimitsThatMakeNoSenseAreRefused()
        {
            Assert.Throws<ArgumentException>(delegate { new Pid(new PidGains(-1, 0, 0), 1); });
            Assert.Throws<ArgumentException>(delegate { new Pid(new PidGains(0, double.NaN, 0), 1); });
            Assert.Throws<ArgumentException>(delegate { new Pid(new PidGains(1, 0, 0), 0); });
            Assert.Throws<ArgumentException>(
                delegate { new Pid(new PidGains(1, 0, 0), double.PositiveInfinity); });
        }
    }
}
