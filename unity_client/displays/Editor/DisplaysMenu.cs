// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Unity;
using UnityEditor;
using UnityEngine;

namespace Ros2Gateway.Editor
{
    /// <summary>GameObject > ROS 2 Gateway: ready objects for a scene.</summary>
    public static class DisplaysMenu
    {
        private const string Path = "GameObject/ROS 2 Gateway/";
        private const int Priority = 10; // among the other kinds of objects, as Unity's manual asks for

        /// <summary>The view of a camera of the scene, for ROS.</summary>
        [MenuItem(Path + "Texture Publisher", false, Priority)]
        public static void Texture(MenuCommand command)
        {
            GameObject camera = new("Texture Publisher", typeof(Camera), typeof(TopicPublisher));
            SceneParts.PublishPictures(camera.GetComponent<TopicPublisher>());
            TexturePublisher texture = camera.AddComponent<TexturePublisher>();
            texture.Camera = camera.GetComponent<Camera>();
            GatewayMenu.Finish(texture, command);
        }

        /// <summary>A screen for a camera's pictures.</summary>
        [MenuItem(Path + "Image Screen", false, Priority)]
        public static void ImageScreen(MenuCommand command)
        {
            GameObject screen = GameObject.CreatePrimitive(PrimitiveType.Quad);
            screen.name = "Image Screen";
            SceneParts.Subscribe(screen, "/camera/image_raw", "sensor_msgs/msg/Image");
            GatewayMenu.Finish(screen.AddComponent<ImageScreen>(), command);
        }

        /// <summary>A screen for any topic, as text.</summary>
        [MenuItem(Path + "Text Screen", false, Priority)]
        public static void TextScreen(MenuCommand command)
        {
            GameObject screen = Text("Text Screen");
            SceneParts.Subscribe(screen, "/chatter", "");
            GatewayMenu.Finish(screen.AddComponent<TextScreen>(), command);
        }

        /// <summary>A screen for the log of ROS and the client's events.</summary>
        [MenuItem(Path + "Log Screen", false, Priority)]
        public static void LogScreen(MenuCommand command)
        {
            GameObject screen = Text("Log Screen");
            GatewayMenu.Finish(screen.AddComponent<LogScreen>(), command);
        }

        /// <summary>The state of the connection, as text.</summary>
        [MenuItem(Path + "Connection HUD", false, Priority)]
        public static void Hud(MenuCommand command)
        {
            GameObject hud = Text("Connection HUD");
            GatewayMenu.Finish(hud.AddComponent<ConnectionHud>(), command);
        }

        /// <summary>Follows a robot's odometry.</summary>
        [MenuItem(Path + "Digital Twin", false, Priority)]
        public static void Twin(MenuCommand command)
        {
            GameObject twin = new("Digital Twin");
            SceneParts.Subscribe(twin, "/odom", "nav_msgs/msg/Odometry");
            GatewayMenu.Finish(twin.AddComponent<DigitalTwin>(), command);
        }

        /// <summary>The points of a laser scanner.</summary>
        [MenuItem(Path + "Laser Scan", false, Priority)]
        public static void LaserScan(MenuCommand command)
        {
            GameObject scan = new("Laser Scan");
            SceneParts.Subscribe(scan, "/scan", "sensor_msgs/msg/LaserScan");
            GatewayMenu.Finish(scan.AddComponent<LaserScanDisplay>(), command);
        }

        /// <summary>A cloud of points.</summary>
        [MenuItem(Path + "Point Cloud", false, Priority)]
        public static void PointCloud(MenuCommand command)
        {
            GameObject cloud = new("Point Cloud");
            SceneParts.Subscribe(cloud, "/points", "sensor_msgs/msg/PointCloud2");
            GatewayMenu.Finish(cloud.AddComponent<PointCloudDisplay>(), command);
        }

        /// <summary>A battery's charge, as text.</summary>
        [MenuItem(Path + "Battery", false, Priority)]
        public static void Battery(MenuCommand command)
        {
            GameObject battery = Text("Battery");
            SceneParts.Subscribe(battery, "/battery_state", "sensor_msgs/msg/BatteryState");
            GatewayMenu.Finish(battery.AddComponent<BatteryDisplay>(), command);
        }

        /// <summary>The arrow keys drive.</summary>
        [MenuItem(Path + "Teleop Driver", false, Priority)]
        public static void Teleop(MenuCommand command) =>
            GatewayMenu.Finish(new GameObject("Teleop Driver").AddComponent<TeleopDriver>(), command);

        /// <summary>A point of the scene is driven to.</summary>
        [MenuItem(Path + "Target Driver", false, Priority)]
        public static void Target(MenuCommand command) =>
            GatewayMenu.Finish(new GameObject("Target Driver").AddComponent<TargetDriver>(), command);

        /// <summary>The robot is recorded.</summary>
        [MenuItem(Path + "Robot Recorder", false, Priority)]
        public static void Recorder(MenuCommand command) =>
            GatewayMenu.Finish(new GameObject("Robot Recorder").AddComponent<RobotRecorder>(), command);

        private static GameObject Text(string name)
        {
            GameObject made = new(name);
            SceneParts.AddText(made);
            return made;
        }
    }
}
