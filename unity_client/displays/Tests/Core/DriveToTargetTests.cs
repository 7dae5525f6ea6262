// SPDX-License-Identifier: Apache-2.0
using System;
using NUnit.Framework;
using Ros2Gateway.Drive;

namespace Ros2Gateway.Tests
{
    [TestFixture]
    public class DriveToTargetTests
    {
        private static readonly PlanarPose Origin = new(0, 0, 0);

        [TestCase(0.0, 0.0)]
        [TestCase(0.03, 0.002)]
        [TestCase(0.10, 0.004)]
        [TestCase(0.20, 0.0)]
        public void HundredRandomTargetsAreReachedWithinFiveCentimetres(double delay, double noise)
        {
            var settings = new DriveSettings();
            var drive = new DriveToTarget(settings);
            var robot = new SimulatedBase(7, delay, noise);
            var random = new Random(8);
            for (int i = 0; i < 100; i++)
            {
                double x = 6 * random.NextDouble() - 3, y = 6 * random.NextDouble() - 3;
                double way = robot.Distance(x, y);
                double start = robot.Now;
                Assert.AreEqual(DriveState.Done, DriveLoop.Run(drive, settings, robot, x, y), drive.Reason);
                Assert.Less(robot.Distance(x, y), 0.05);
                Assert.Less(robot.Now - start, 12 + 1.5 * way / settings.maxLinear, "robot's seconds");
                Assert.AreEqual("", drive.Reason);
            }
        }

        [Test]
        public void NearTargetsAreReachedWithinFiveCentimetres()
        {
            var settings = new DriveSettings();
            var drive = new DriveToTarget(settings);
            var robot = new SimulatedBase(9, 0.06, 0.003);
            var random = new Random(10);
            for (int i = 0; i < 100; i++)
            {
                double x = robot.Truth.x + 0.3 * random.NextDouble() - 0.15;
                double y = robot.Truth.y + 0.3 * random.NextDouble() - 0.15;
                Assert.AreEqual(DriveState.Done, DriveLoop.Run(drive, settings, robot, x, y), drive.Reason);
                Assert.Less(robot.Distance(x, y), 0.05);
            }
        }

        [Test]
        public void ATargetBehindIsTurnedToTheWayBegunWhateverTheNoise()
        {
            var drive = new DriveToTarget(new DriveSettings());
            drive.SetTarget(-1, 0.001, 0);
            for (int i = 0; i < 20; i++)
            {
                // The target is now left of straight behind, now right of it.
                double yaw = i % 2 == 0 ? 0.02 : -0.02;
                DriveCommand command = drive.Step(new PlanarPose(0, 0, yaw), 0.05 * i, 0.05 * i);
                Assert.Greater(command.angular, 0);
            }
        }

        [Test]
        public void ARobotThatIsTurnedFarTheOtherWayTakesTheShortWayFromThere()
        {
            var drive = new DriveToTarget(new DriveSettings());
            drive.SetTarget(-1, 0.001, 0);
            Assert.Greater(drive.Step(Origin, 0, 0).angular, 0);
            Assert.Less(drive.Step(new PlanarPose(0, 0, -2), 0.05, 0.05).angular, 0);
        }

        [Test]
        public void OnTheWayItSteersUntilTheTargetIsNear()
        {
            var drive = new DriveToTarget(new DriveSettings());
            drive.SetTarget(1, 0, 0);
            drive.Step(Origin, 0, 0);
            Assert.Greater(drive.Step(new PlanarPose(0, 0, -0.2), 0.05, 0.05).angular, 0);
            Assert.Less(drive.Step(new PlanarPose(0, 0, 0.2), 0.1, 0.1).angular, 0);
            Assert.AreEqual(0, drive.Step(new PlanarPose(0.95, 0.02, 0.2), 0.15, 0.15).angular);
            Assert.AreEqual(DriveState.Driving, drive.State);
        }

        [Test]
        public void ATargetJustPassedIsReversedTo()
        {
            var drive = new DriveToTarget(new DriveSettings());
            drive.SetTarget(1, 0, 0);
            drive.Step(Origin, 0, 0);
            DriveCommand command = drive.Step(new PlanarPose(1.06, 0, 0), 0.05, 0.05);
            Assert.AreEqual(DriveState.Driving, drive.State);
            Assert.Less(command.linear, 0);
        }

        [Test]
        public void ATargetMissedToTheSideIsTurnedTo()
        {
            var drive = new DriveToTarget(new DriveSettings());
            drive.SetTarget(1, 0, 0);
            drive.Step(Origin, 0, 0);
            DriveCommand command = drive.Step(new PlanarPose(1, 0.05, 0), 0.05, 0.05);
            Assert.AreEqual(DriveState.Turning, drive.State);
            Assert.Less(command.angular, 0);
            Assert.AreEqual(0, command.linear);
        }

        [TestCase(3.0, -3.0)]
        [TestCase(-3.0, 3.0)]
        [TestCase(3.1, 3.0)]
        [TestCase(-2.0, 2.0)]
        [TestCase(2.0, -2.0)]
        public void TurningTakesTheShortWayAcrossPi(double yaw, double bearing)
        {
            var drive = new DriveToTarget(new DriveSettings());
            drive.SetTarget(Math.Cos(bearing), Math.Sin(bearing), 0);
            DriveCommand command = drive.Step(new PlanarPose(0, 0, yaw), 0, 0);
            Assert.AreEqual(DriveState.Turning, drive.State);
            Assert.AreEqual(Math.Sign(Planar.Wrap(bearing - yaw)), Math.Sign(command.angular));
            Assert.AreEqual(0, command.linear);
        }

        [Test]
        public void ATargetUnderTheRobotIsReachedAtOnce()
        {
            var drive = new DriveToTarget(new DriveSettings());
            drive.SetTarget(0.01, -0.01, 0);
            Assert.AreEqual(DriveCommand.Zero, drive.Step(Origin, 0, 0));
            Assert.AreEqual(DriveState.Done, drive.State);
            drive.Stop("too late to stop");
            Assert.AreEqual(DriveState.Done, drive.State);
        }

        [Test]
        public void ARobotThatIsTurnedOnTheWayTurnsBackFirst()
        {
            var settings = new DriveSettings();
            var drive = new DriveToTarget(settings);
            var robot = new SimulatedBase(11, 0.05, 0);
            drive.SetTarget(2, 0, robot.Now);
            while (drive.State != DriveState.Driving || robot.Truth.x < 0.5)
            {
                DriveLoop.Step(drive, settings, robot);
            }
            robot.Truth = new PlanarPose(robot.Truth.x, robot.Truth.y, 2);
            while (drive.State == DriveState.Driving)
            {
                DriveLoop.Step(drive, settings, robot);
            }
            Assert.AreEqual(DriveState.Turning, drive.State);
            while (drive.IsActive)
            {
                DriveLoop.Step(drive, settings, robot);
            }
            Assert.AreEqual(DriveState.Done, drive.State, drive.Reason);
            Assert.Less(robot.Distance(2, 0), 0.05);
        }

        [Test]
        public void ABlockedRobotIsGivenUpInWords()
        {
            var settings = new DriveSettings();
            var drive = new DriveToTarget(settings);
            var robot = new SimulatedBase(12, 0.05, 0.001) { IsBlocked = true };
            Assert.AreEqual(DriveState.Failed, DriveLoop.Run(drive, settings, robot, 1, 1));
            StringAssert.IsMatch(@"^no progress for 5\.\d s, 1\.4\d m from the target$", drive.Reason);
        }

        [Test]
        public void ARobotThatOnlyCreepsIsGivenUpInTime()
        {
            var drive = new DriveToTarget(new DriveSettings());
            drive.SetTarget(1, 0, 0);
            drive.Step(Origin, 0, double.NaN); // and NaN as a time does not delay it
            double now = 0;
            while (drive.IsActive)
            {
                now += 0.1;
                drive.Step(new PlanarPose(0.01 * now, 0, 0), now, now);
                Assert.Less(now, 100);
            }
            Assert.AreEqual(DriveState.Failed, drive.State);
            StringAssert.IsMatch(@"^not there after \d\d\.\d s, 0\.\d\d m from the target$", drive.Reason);
        }

        [Test]
        public void WithoutOdometryTheRobotStandsAndWaitsThenFails()
        {
            var settings = new DriveSettings();
            var drive = new DriveToTarget(settings);
            var robot = new SimulatedBase(13, 0.02, 0);
            drive.SetTarget(2, 1, robot.Now);
            while (drive.State != DriveState.Driving)
            {
                DriveLoop.Step(drive, settings, robot);
            }
            robot.HasOdometry = false;
            double lost = robot.Now;
            while (drive.State == DriveState.Driving)
            {
                DriveLoop.Step(drive, settings, robot);
            }
            Assert.AreEqual(DriveState.Waiting, drive.State);
            Assert.AreEqual("waiting for a fresh pose", drive.Reason);
            Assert.AreEqual(settings.staleSeconds, robot.Now - lost, 0.15);
            while (drive.IsActive)
            {
                Assert.AreEqual(DriveCommand.Zero, DriveLoop.Step(drive, settings, robot));
            }
            Assert.AreEqual(DriveState.Failed, drive.State);
            StringAssert.IsMatch(@"^no fresh pose for 5\.\d s$", drive.Reason);
        }

        [Test]
        public void OdometryThatComesBackIsDrivenByAgain()
        {
            var settings = new DriveSettings();
            var drive = new DriveToTarget(settings);
            var robot = new SimulatedBase(14, 0.02, 0) { HasOdometry = false };
            drive.SetTarget(1, 0, robot.Now);
            DriveLoop.Step(drive, settings, robot);
            Assert.AreEqual("waiting for the first pose", drive.Reason);
            robot.HasOdometry = true;
            while (drive.IsActive)
            {
                DriveLoop.Step(drive, settings, robot);
            }
            Assert.AreEqual(DriveState.Done, drive.State, drive.Reason);
        }

        [Test]
        public void GapsInTheOdometryDoNotAddUp()
        {
            var drive = new DriveToTarget(new DriveSettings());
            drive.SetTarget(1, 0, 0);
            double now = 0, x = 0;
            for (int gap = 0; gap < 4; gap++)
            {
                x += 0.1;
                double poseTime = now;
                for (int i = 0; i < 40; i++)
                {
                    drive.Step(new PlanarPose(x, 0, 0), poseTime, now);
                    now += 0.1;
                }
                Assert.AreEqual(DriveState.Waiting, drive.State, drive.Reason);
            }
        }

        [Test]
        public void APauseOfTheWholeApplicationIsNotHeldAgainstTheRobot()
        {
            var drive = new DriveToTarget(new DriveSettings());
            drive.SetTarget(1, 0, 0);
            drive.Step(Origin, 0, 0);
            Assert.AreNotEqual(DriveCommand.Zero, drive.Step(Origin, 600, 600));
            Assert.AreEqual(DriveState.Driving, drive.State, drive.Reason);
        }

        [Test]
        public void PosesThatAreOldWhenTheyComeAreNotDrivenBy()
        {
            var drive = new DriveToTarget(new DriveSettings());
            drive.SetTarget(1, 0, 10);
            double now = 10;
            while (drive.IsActive)
            {
                now += 0.05;
                Assert.AreEqual(DriveCommand.Zero, drive.Step(Origin, now - 0.6, now));
                Assert.Less(now, 20);
            }
            Assert.AreEqual(DriveState.Failed, drive.State);
        }

        [TestCase(double.NaN, 0, 0)]
        [TestCase(0, double.PositiveInfinity, 0)]
        [TestCase(0, 0, double.NaN)]
        public void APoseThatIsNotFiniteIsNone(double x, double y, double yaw)
        {
            var drive = new DriveToTarget(new DriveSettings());
            drive.SetTarget(1, 0, 0);
            drive.Step(Origin, 0, 0);
            Assert.AreEqual(DriveState.Driving, drive.State);
            Assert.AreEqual(DriveCommand.Zero, drive.Step(new PlanarPose(x, y, yaw), 0.05, 0.05));
            Assert.AreEqual(DriveState.Waiting, drive.State);
        }

        [Test]
        public void TimesThatAreNotFiniteGiveZero()
        {
            var drive = new DriveToTarget(new DriveSettings());
            drive.SetTarget(1, 0, 0);
            Assert.AreEqual(DriveCommand.Zero, drive.Step(Origin, 0, double.NaN));
            Assert.AreEqual(DriveCommand.Zero, drive.Step(Origin, double.NaN, 0));
            Assert.AreNotEqual(DriveCommand.Zero, drive.Step(Origin, 0.1, 0.1));
            Assert.AreEqual(DriveCommand.Zero, drive.Step(Origin, 0.1, double.NaN));
            Assert.AreEqual(DriveCommand.Zero, drive.Step(Origin, double.PositiveInfinity, 0.1));
            // Nothing of it is remembered: a robot that does not move is still given up.
            for (int i = 2; drive.IsActive; i++)
            {
                drive.Step(Origin, 0.1 * i, 0.1 * i);
                Assert.Less(i, 100);
            }
            Assert.AreEqual(DriveState.Failed, drive.State);
        }

        [Test]
        public void AClockThatGoesBackDoesNotStopTheDriveNorKeepAStalePoseFresh()
        {
            var drive = new DriveToTarget(new DriveSettings());
            drive.SetTarget(1, 0, 1000);
            for (int i = 0; i < 20; i++)
            {
                drive.Step(Origin, 1000 + 0.05 * i, 1000 + 0.05 * i);
            }
            Assert.AreEqual(DriveState.Driving, drive.State);
            Assert.AreNotEqual(DriveCommand.Zero, drive.Step(Origin, 10, 10));
            Assert.AreEqual(DriveState.Driving, drive.State);
            // The clock goes back once more, and no pose follows.
            double now = 5;
            for (int i = 0; i < 13; i++)
            {
                drive.Step(Origin, 10, now);
                now += 0.05;
            }
            Assert.AreEqual(DriveState.Waiting, drive.State);
        }

        [Test]
        public void AStopIsKeptWithItsReason()
        {
            var drive = new DriveToTarget(new DriveSettings());
            drive.SetTarget(1, 0, 0);
            Assert.AreNotEqual(DriveCommand.Zero, drive.Step(Origin, 0, 0));
            drive.Stop("grip pressed");
            Assert.AreEqual(DriveState.Idle, drive.State);
            Assert.AreEqual("grip pressed", drive.Reason);
            Assert.AreEqual(DriveCommand.Zero, drive.Step(Origin, 0.1, 0.1));
            Assert.AreEqual(DriveState.Idle, drive.State);
        }

        [Test]
        public void ANewTargetReplacesTheOldOne()
        {
            var settings = new DriveSettings();
            var drive = new DriveToTarget(settings);
            var robot = new SimulatedBase(15, 0.05, 0.002);
            drive.SetTarget(2, 0, robot.Now);
            for (int i = 0; i < 60; i++)
            {
                DriveLoop.Step(drive, settings, robot);
            }
            Assert.AreEqual(DriveState.Done, DriveLoop.Run(drive, settings, robot, -0.5, 0.5), drive.Reason);
            Assert.Less(robot.Distance(-0.5, 0.5), 0.05);
        }

        [TestCase(double.NaN, 0, 0)]
        [TestCase(0, double.NegativeInfinity, 0)]
        [TestCase(0, 0, double.NaN)]
        public void ATargetThatIsNotFiniteFailsAtOnce(double x, double y, double now)
        {
            var drive = new DriveToTarget(new DriveSettings());
            drive.SetTarget(x, y, now);
            Assert.AreEqual(DriveState.Failed, drive.State);
            Assert.AreEqual("the target is not finite", drive.Reason);
            Assert.AreEqual(DriveCommand.Zero, drive.Step(Origin, 0, 0));
        }

        [Test]
        public void WithoutATargetTheCommandIsZero()
        {
            var drive = new DriveToTarget(new DriveSettings());
            Assert.AreEqual(DriveState.Idle, drive.State);
            Assert.AreEqual(DriveCommand.Zero, drive.Step(Origin, 0, 0));
        }

        [Test]
        public void CommandsStayFiniteAndWithinLimitsWhateverComes()
        {
            double[] odd =
            {
                0, 1, -1, 3.2, 1e-300, 1e9, -1e300, double.MaxValue, double.NaN, double.PositiveInfinity,
                double.NegativeInfinity,
            };
            var settings = new DriveSettings();
            var random = new Random(16);
            var drive = new DriveToTarget(settings);
            for (int i = 0; i < 20000; i++)
            {
                if (!drive.IsActive || i % 50 == 0)
                {
                    drive.SetTarget(Any(random, odd), Any(random, odd), random.Next(3));
                }
                var pose = new PlanarPose(Any(random, odd), Any(random, odd), Any(random, odd));
                DriveCommand command = drive.Step(pose, random.NextDouble(), random.NextDouble());
                Assert.IsTrue(Math.Abs(command.linear) <= settings.maxLinear, command.ToString());
                Assert.IsTrue(Math.Abs(command.angular) <= settings.maxAngular, command.ToString());
            }
        }

        [Test]
        public void SettingsThatMakeNoSenseAreRefusedByName()
        {
            var error = Assert.Throws<ArgumentException>(
                delegate { new DriveToTarget(new DriveSettings { tolerance = double.NaN }); });
            StringAssert.Contains("tolerance", error.Message);
            Assert.Throws<ArgumentException>(
                delegate { new DriveToTarget(new DriveSettings { aim = 0.5 }); });
            Assert.Throws<ArgumentException>(
                delegate { new DriveToTarget(new DriveSettings { aim = 1.4, drift = 1.5 }); });
            Assert.Throws<ArgumentException>(
                delegate { new DriveToTarget(new DriveSettings { turning = new PidGains(-1, 0, 0) }); });
        }

        private static double Any(Random random, double[] odd) =>
            random.Next(4) == 0 ? odd[random.Next(odd.Length)] : 4 * random.NextDouble() - 2;
    }
}
