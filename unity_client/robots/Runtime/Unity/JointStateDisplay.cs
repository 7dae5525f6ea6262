// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Messages.SensorMsgs;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>Moves the joints of a robot that a Robot Description Display has built.</summary>
    [AddComponentMenu("ROS 2 Gateway/Joint State Display")]
    public sealed class JointStateDisplay : TypedDisplay<JointStateMsg>
    {
        [SerializeField]
        [Tooltip("Empty: the one above in the hierarchy")]
        private RobotDescriptionDisplay _robot;

        /// <summary>Whose joints these are. Null for the one above.</summary>
        public RobotDescriptionDisplay Robot
        {
            get => _robot;
            set => _robot = value;
        }

        /// <summary>How many joints the newest message moved.</summary>
        public int Moved { get; private set; }

        /// <inheritdoc/>
        protected override bool DrawsEvery
        {
            get { return true; } // an arm and its gripper may be published apart, on one topic
        }

        /// <inheritdoc/>
        protected override bool Draw(JointStateMsg message)
        {
            Moved = 0;
            _robot = _robot != null ? _robot : GetComponentInParent<RobotDescriptionDisplay>();
            if (_robot == null)
            {
                Warn("no Robot Description Display: choose one, or put this below one");
                return false;
            }
            string[] names = message.name;
            double[] positions = message.position;
            if (names == null || positions == null || names.Length != positions.Length)
            {
                Warn("the joints have " + (names == null ? 0 : names.Length) + " names and "
                    + (positions == null ? 0 : positions.Length) + " positions");
                return false;
            }
            for (int i = 0; i < names.Length; i++)
            {
                Moved += _robot.SetJoint(names[i], positions[i]) ? 1 : 0;
            }
            return _robot.Robot != null;
        }
    }
}
