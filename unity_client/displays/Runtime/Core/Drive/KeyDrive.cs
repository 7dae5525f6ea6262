// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway.Drive
{
    /// <summary>The keys that drive, or whatever stands for them.</summary>
    [Flags]
    public enum DriveKeys
    {
        /// <summary>None is held.</summary>
        None = 0,

        /// <summary>Ahead.</summary>
        Forward = 1,

        /// <summary>Astern.</summary>
        Back = 2,

        /// <summary>Turn counter-clockwise.</summary>
        Left = 4,

        /// <summary>Turn clockwise.</summary>
        Right = 8,
    }

    /// <summary>
    /// Drives a robot by keys: a command when they change, repeated while one is held, a single zero on
    /// release. Pure: keys and time are arguments. Not for several threads.
    /// </summary>
    public sealed class KeyDrive
    {
        private readonly double _linear;
        private readonly double _angular;
        private readonly double _period;
        private DriveKeys _held;
        private DriveKeys _ignored;
        private DriveCommand _sent;
        private double _sentTime;

        /// <summary>
        /// Takes the speeds, m/s and rad/s, and how often a held key repeats, Hz. Robots stop by themselves
        /// after half a second of silence or so, and 15 Hz survives a few lost frames. Defaults as a
        /// TurtleBot3's.
        /// </summary>
        /// <exception cref="ArgumentException">A number is not finite and above 0.</exception>
        public KeyDrive(double linear = 0.26, double angular = 1.82, double rate = 15)
        {
            if (!(linear > 0 && angular > 0 && rate > 0) || double.IsInfinity(linear + angular + rate))
            {
                throw new ArgumentException("speeds and rate of the keys are finite and above 0");
            }
            _linear = linear;
            _angular = angular;
            _period = 1 / rate;
        }

        /// <summary>
        /// Whether there is something to send now, and what. Call it every frame with the keys that are held.
        /// Opposite keys cancel each other.
        /// </summary>
        public bool Step(DriveKeys keys, double now, out DriveCommand command)
        {
            _held = keys;
            _ignored &= keys;
            keys &= ~_ignored;
            command = new DriveCommand(
                _linear * (Sign(keys, DriveKeys.Forward) - Sign(keys, DriveKeys.Back)),
                _angular * (Sign(keys, DriveKeys.Left) - Sign(keys, DriveKeys.Right)));
            double silence = now - _sentTime;
            // A clock that went back must not silence a held key.
            bool isDue = !command.Equals(DriveCommand.Zero) && (silence >= _period || silence < 0);
            if (command.Equals(_sent) && !isDue)
            {
                return false;
            }
            _sent = command;
            _sentTime = now;
            return true;
        }

        /// <summary>
        /// Lets go of everything, for the loss of focus, a pause or a disconnection. The next step gives zero
        /// where the robot was driving, and a key that is held counts again once it was released.
        /// </summary>
        public void Release() => _ignored = _held;

        private static int Sign(DriveKeys keys, DriveKeys key) => (keys & key) != 0 ? 1 : 0;
    }
}
