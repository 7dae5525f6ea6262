// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Unity;
using UnityEditor;
using UnityEngine;

namespace Ros2Gateway.Editor
{
    /// <summary>GameObject > ROS 2 Gateway: robots by their descriptions.</summary>
    public static class RobotsMenu
    {
        private const string Path = "GameObject/ROS 2 Gateway/";
        private const int Priority = 30; // below the others, after a line

        /// <summary>A robot by its description, whose joints move.</summary>
        [MenuItem(Path + "Robot", false, Priority)]
        public static void RobotDescriptionDisplay(MenuCommand command)
        {
            GameObject robot = new("Robot");
            SceneParts.Subscribe(robot, "/robot_description", "std_msgs/msg/String");
            robot.AddComponent<RobotDescriptionDisplay>();
            GameObject joints = new("Joint States");
            joints.transform.SetParent(robot.transform, false);
            SceneParts.Subscribe(joints, "/joint_states", "sensor_msgs/msg/JointState");
            joints.AddComponent<JointStateDisplay>();
            GatewayMenu.Finish(robot.transform, command);
        }
    }
}
