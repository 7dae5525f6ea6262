// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Unity;
using UnityEditor;
using UnityEngine;

namespace Ros2Gateway.Editor
{
    /// <summary>GameObject > ROS 2 Gateway: what stands in the frames of a robot, and goals for it.</summary>
    public static class FramesMenu
    {
        private const string Path = "GameObject/ROS 2 Gateway/";
        private const int Priority = 30; // below the others, after a line
        private const int MarkerQueue = 32; // each message may add to the others
        private const float DepthRate = 5; // pictures a second: each is decoded on the main thread

        /// <summary>The origin of a ROS frame. Its displays go below.</summary>
        [MenuItem(Path + "Fixed Frame", false, Priority)]
        public static void FixedFrame(MenuCommand command) =>
            GatewayMenu.Finish(new GameObject("Fixed Frame").AddComponent<FixedFrame>(), command);

        /// <summary>Follows a frame of the robot.</summary>
        [MenuItem(Path + "Frame Follower", false, Priority)]
        public static void FrameFollower(MenuCommand command) =>
            GatewayMenu.Finish(new GameObject("Frame Follower").AddComponent<FrameFollower>(), command);

        /// <summary>The robot's map, on the ground.</summary>
        [MenuItem(Path + "Map", false, Priority)]
        public static void OccupancyGridDisplay(MenuCommand command)
        {
            GameObject made = new("Map");
            SceneParts.Subscribe(made, "/map", "nav_msgs/msg/OccupancyGrid");
            GatewayMenu.Finish(made.AddComponent<OccupancyGridDisplay>(), command);
        }

        /// <summary>The way that a planner has found.</summary>
        [MenuItem(Path + "Path", false, Priority)]
        public static void PathDisplay(MenuCommand command)
        {
            GameObject made = new("Path");
            SceneParts.Subscribe(made, "/plan", "nav_msgs/msg/Path");
            GatewayMenu.Finish(made.AddComponent<PathDisplay>(), command);
        }

        /// <summary>A pose, such as a goal, as an arrow.</summary>
        [MenuItem(Path + "Pose", false, Priority)]
        public static void PoseDisplay(MenuCommand command)
        {
            GameObject made = new("Pose");
            SceneParts.Subscribe(made, "/goal_pose", "geometry_msgs/msg/PoseStamped");
            GatewayMenu.Finish(made.AddComponent<PoseDisplay>(), command);
        }

        /// <summary>Many poses, such as a localisation's particles, as arrows.</summary>
        [MenuItem(Path + "Pose Array", false, Priority)]
        public static void PoseArrayDisplay(MenuCommand command)
        {
            GameObject made = new("Pose Array");
            SceneParts.Subscribe(made, "/particle_cloud", "geometry_msgs/msg/PoseArray");
            GatewayMenu.Finish(made.AddComponent<PoseArrayDisplay>(), command);
        }

        /// <summary>The places where a robot has been.</summary>
        [MenuItem(Path + "Odometry Trail", false, Priority)]
        public static void OdometryTrail(MenuCommand command)
        {
            GameObject made = new("Odometry Trail");
            SceneParts.Subscribe(made, "/odom", "nav_msgs/msg/Odometry");
            GatewayMenu.Finish(made.AddComponent<OdometryTrail>(), command);
        }

        /// <summary>The markers of programs.</summary>
        [MenuItem(Path + "Markers", false, Priority)]
        public static void MarkerArrayDisplay(MenuCommand command)
        {
            GameObject made = new("Markers");
            SceneParts.Subscribe(made, "/markers", "visualization_msgs/msg/MarkerArray")
                .GetComponent<TopicSubscriber>().Queue = MarkerQueue;
            GatewayMenu.Finish(made.AddComponent<MarkerArrayDisplay>(), command);
        }

        /// <summary>The view of a depth camera, as points.</summary>
        [MenuItem(Path + "Depth", false, Priority)]
        public static void DepthDisplay(MenuCommand command)
        {
            GameObject made = new("Depth");
            TopicSubscriber subscriber = SceneParts.Subscribe(
                made, "/camera/depth/image_raw", "sensor_msgs/msg/Image").GetComponent<TopicSubscriber>();
            subscriber.ImageFormat = "png";
            subscriber.MaxRate = DepthRate;
            GatewayMenu.Finish(made.AddComponent<DepthDisplay>(), command);
        }

        /// <summary>The place of this object becomes a goal.</summary>
        [MenuItem(Path + "Goal Pose Publisher", false, Priority)]
        public static void GoalPosePublisher(MenuCommand command) =>
            GatewayMenu.Finish(new GameObject("Goal Pose Publisher").AddComponent<GoalPosePublisher>(), command);

        /// <summary>The place of this object becomes a goal of Nav2's action.</summary>
        [MenuItem(Path + "Navigate To Pose", false, Priority)]
        public static void NavigateToPose(MenuCommand command) =>
            GatewayMenu.Finish(new GameObject("Navigate To Pose").AddComponent<NavigateToPose>(), command);
    }
}
