// SPDX-License-Identifier: Apache-2.0
using System;
using NUnit.Framework;
using Ros2Gateway.Drive;

namespace Ros2Gateway.Tests
{
    [TestFixture]
    public class KeyDriveTests
    {
        [TestCase(DriveKeys.Forward, 0.26, 0)]
        [TestCase(DriveKeys.Back, -0.26, 0)]
        [TestCase(DriveKeys.Left, 0, 1.82)]
        [TestCase(DriveKeys.Right, 0, -1.82)]
        [TestCase(DriveKeys.Forward | DriveKeys.Right, 0.26, -1.82)]
        [TestCase(DriveKeys.Forward | DriveKeys.Back | DriveKeys.Left, 0, 1.82)]
        public void KeysDriveAtTheTurtleBotsSpeeds(DriveKeys keys, double linear, double angular)
        {
            Assert.IsTrue(new KeyDrive().Step(keys, 0, out DriveCommand command));
            Assert.AreEqual(new DriveCommand(linear, angular), command);
        }

        [Test]
        public void AHeldKeyRepeatsAtItsRateHoweverManyFramesThereAre()
        {
            var drive = new KeyDrive(0.26, 1.82, 15);
            Assert.AreEqual(30, Count(drive, DriveKeys.Forward, 0, 2, 1.0 / 240), 1);
            Assert.AreEqual(20, Count(drive, DriveKeys.Forward, 2, 4, 1.0 / 10), 1);
        }

        [Test]
        public void AReleaseSendsZeroOnce()
        {
            var drive = new KeyDrive();
            drive.Step(DriveKeys.Forward, 0, out DriveCommand command);
            Assert.IsTrue(drive.Step(DriveKeys.None, 0.01, out command));
            Assert.AreEqual(DriveCommand.Zero, command);
            Assert.AreEqual(0, Count(drive, DriveKeys.None, 0.02, 2, 0.01));
        }

        [Test]
        public void NothingIsSentBeforeTheFirstKey() => Assert.AreEqual(0, Count(new KeyDrive(), DriveKeys.None, 0, 2, 0.01));

        [Test]
        public void AnotherKeyIsSentAtOnce()
        {
            var drive = new KeyDrive();
            drive.Step(DriveKeys.Forward, 0, out DriveCommand command);
            Assert.IsFalse(drive.Step(DriveKeys.Forward, 0.001, out command));
            Assert.IsTrue(drive.Step(DriveKeys.Forward | DriveKeys.Left, 0.002, out command));
            Assert.AreEqual(new DriveCommand(0.26, 1.82), command);
        }

        [Test]
        public void LosingFocusSendsZeroAndHeldKeysMustBePressedAnew()
        {
            var drive = new KeyDrive();
            drive.Step(DriveKeys.Forward, 0, out DriveCommand command);
            drive.Release();
            Assert.IsTrue(drive.Step(DriveKeys.Forward, 0.01, out command));
            Assert.AreEqual(DriveCommand.Zero, command);
            Assert.AreEqual(0, Count(drive, DriveKeys.Forward, 0.02, 2, 0.01));
            Assert.IsTrue(drive.Step(DriveKeys.Forward | DriveKeys.Left, 2, out command));
            Assert.AreEqual(new DriveCommand(0, 1.82), command);
            drive.Step(DriveKeys.None, 2.1, out command);
            Assert.IsTrue(drive.Step(DriveKeys.Forward, 2.2, out command));
            Assert.AreEqual(new DriveCommand(0.26, 0), command);
        }

        [Test]
        public void AClockThatGoesBackDoesNotSilenceAHeldKey()
        {
            var drive = new KeyDrive();
            drive.Step(DriveKeys.Forward, 1000, out DriveCommand command);
            Assert.AreEqual(15, Count(drive, DriveKeys.Forward, 10, 11, 1.0 / 60), 2);
        }

        [TestCase(0, 1, 1)]
        [TestCase(1, double.NaN, 1)]
        [TestCase(1, 1, double.PositiveInfinity)]
        public void SpeedsThatMakeNoSenseAreRefused(double linear, double angular, double rate) =>
            Assert.Throws<ArgumentException>(delegate { new KeyDrive(linear, angular, rate); });

        private static int Count(KeyDrive drive, DriveKeys keys, double from, double to, double frame)
        {
            int count = 0;
            DriveCommand command;
            for (double now = from; now < to; now += frame)
            {
                count += drive.Step(keys, now, out command) ? 1 : 0;
            }
            return count;
        }
    }
}
