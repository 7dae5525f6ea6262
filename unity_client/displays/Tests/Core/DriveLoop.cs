// SPDX-License-Identifier: Apache-2.0
using System;
using NUnit.Framework;
using Ros2Gateway.Drive;

namespace Ros2Gateway.Tests
{
    /// <summary>
    /// The source of poses, and the target of commands: a simulation in here, or a robot behind a gateway.
    /// </summary>
    public interface IDrivenRobot
    {
        /// <summary>Seconds of the clock that all this runs by.</summary>
        double Now { get; }

        /// <summary>The newest pose and when it came. False before the first.</summary>
        bool TryGetPose(out PlanarPose pose, out double time);

        /// <summary>Sends a command.</summary>
        void Command(DriveCommand command);

        /// <summary>Lets some time pass, a control period or so.</summary>
        void Wait();
    }

    /// <summary>Closes the loop of a <see cref="DriveToTarget"/> over any robot.</summary>
    public static class DriveLoop
    {
        /// <summary>
        /// Drives to a target, then lets the robot come to rest. Demands of every command that it is finite
        /// and within the settings' limits. Returns the state that driving ended in.
        /// </summary>
        public static DriveState Run(
            DriveToTarget drive, DriveSettings settings, IDrivenRobot robot, double x, double y)
        {
            drive.SetTarget(x, y, robot.Now);
            while (drive.IsActive)
            {
                Step(drive, settings, robot);
            }
            DriveState end = drive.State;
            double rest = robot.Now + 0.5;
            while (robot.Now < rest)
            {
                Assert.AreEqual(DriveCommand.Zero, Step(drive, settings, robot));
            }
            return end;
        }

        /// <summary>One period: pose in, command out.</summary>
        public static DriveCommand Step(DriveToTarget drive, DriveSettings settings, IDrivenRobot robot)
        {
            if (!robot.TryGetPose(out PlanarPose pose, out double time))
            {
                pose = new PlanarPose(double.NaN, double.NaN, double.NaN);
            }
            DriveCommand command = drive.Step(pose, time, robot.Now);
            // written so that NaN fails it
            Assert.IsTrue(Math.Abs(command.linear) <= settings.maxLinear, command.ToString());
            Assert.IsTrue(Math.Abs(command.angular) <= settings.maxAngular, command.ToString());
            robot.Command(command);
            robot.Wait();
            return command;
        }
    }
}
