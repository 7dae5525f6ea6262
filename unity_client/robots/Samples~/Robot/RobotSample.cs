// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Unity;
using UnityEngine;

namespace Ros2Gateway.Samples.Robot
{
    /// <summary>Builds a robot from its description, at its place in a frame.</summary>
    public sealed class RobotSample : MonoBehaviour
    {
        [SerializeField]
        [Tooltip("The frame of this object")]
        private string _frame = "odom";

        private void Start()
        {
            GameObject origin = SceneParts.New("Fixed Frame", transform);
            origin.AddComponent<FixedFrame>().Frame = _frame;
            GameObject robot = new("Robot");
            robot.transform.SetParent(origin.transform, false);
            SceneParts.Subscribe(robot, "/robot_description", "std_msgs/msg/String");
            robot.AddComponent<RobotDescriptionDisplay>();
            GameObject joints = new("Joint States");
            joints.transform.SetParent(robot.transform, false);
            SceneParts.Subscribe(joints, "/joint_states", "sensor_msgs/msg/JointState");
            joints.AddComponent<JointStateDisplay>();
            origin.SetActive(true);
        }
    }
}
