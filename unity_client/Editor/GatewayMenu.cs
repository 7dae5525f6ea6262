// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Unity;
using UnityEditor;
using UnityEngine;

namespace Ros2Gateway.Editor
{
    /// <summary>GameObject > ROS 2 Gateway: ready objects for a scene.</summary>
    public static class GatewayMenu
    {
        private const string Path = "GameObject/ROS 2 Gateway/";
        private const int Priority = 10; // among the other kinds of objects, as Unity's manual asks for

        /// <summary>The connection that all others find.</summary>
        [MenuItem(Path + "Connection", false, Priority)]
        public static void Connection(MenuCommand command)
        {
            Finish(new GameObject("Gateway Connection", typeof(GatewayConnection)), command);
        }

        /// <summary>Any topic, which is heard.</summary>
        [MenuItem(Path + "Topic Subscriber", false, Priority)]
        public static void Subscriber(MenuCommand command)
        {
            Finish(new GameObject("Topic Subscriber", typeof(TopicSubscriber)), command);
        }

        /// <summary>Any topic, which is written.</summary>
        [MenuItem(Path + "Topic Publisher", false, Priority)]
        public static void Publisher(MenuCommand command)
        {
            Finish(new GameObject("Topic Publisher", typeof(TopicPublisher)), command);
        }

        /// <summary>The view of a camera of the scene, for ROS.</summary>
        [MenuItem(Path + "Texture Publisher", false, Priority)]
        public static void Texture(MenuCommand command)
        {
            GameObject camera = new GameObject("Texture Publisher", typeof(Camera), typeof(TopicPublisher));
            SceneParts.PublishPictures(camera.GetComponent<TopicPublisher>());
            TexturePublisher texture = camera.AddComponent<TexturePublisher>();
            texture.Camera = camera.GetComponent<Camera>();
            Finish(texture, command);
        }

        /// <summary>A screen for a camera's pictures.</summary>
        [MenuItem(Path + "Image Screen", false, Priority)]
        public static void ImageScreen(MenuCommand command)
        {
            GameObject screen = GameObject.CreatePrimitive(PrimitiveType.Quad);
            screen.name = "Image Screen";
            SceneParts.Subscribe(screen, "/camera/image_raw", "sensor_msgs/msg/Image");
            Finish(screen.AddComponent<ImageScreen>(), command);
        }

        /// <summary>A screen for any topic, as text.</summary>
        [MenuItem(Path + "Text Screen", false, Priority)]
        public static void TextScreen(MenuCommand command)
        {
            GameObject screen = Text("Text Screen");
            SceneParts.Subscribe(screen, "/chatter", "");
            Finish(screen.AddComponent<TextScreen>(), command);
        }

        /// <summary>A screen for the log of ROS and the client's events.</summary>
        [MenuItem(Path + "Log Screen", false, Priority)]
        public static void LogScreen(MenuCommand command)
        {
            GameObject screen = Text("Log Screen");
            Finish(screen.AddComponent<LogScreen>(), command);
        }

        /// <summary>The state of the connection, as text.</summary>
        [MenuItem(Path + "Connection HUD", false, Priority)]
        public static void Hud(MenuCommand command)
        {
            GameObject hud = Text("Connection HUD");
            Finish(hud.AddComponent<ConnectionHud>(), command);
        }

        /// <summary>Follows a robot's odometry.</summary>
        [MenuItem(Path + "Digital Twin", false, Priority)]
        public static void Twin(MenuCommand command)
        {
            GameObject twin = new GameObject("Digital Twin");
            SceneParts.Subscribe(twin, "/odom", "nav_msgs/msg/Odometry");
            Finish(twin.AddComponent<DigitalTwin>(), command);
        }

        /// <summary>The points of a laser scanner.</summary>
        [MenuItem(Path + "Laser Scan", false, Priority)]
        public static void LaserScan(MenuCommand command)
        {
            GameObject scan = new GameObject("Laser Scan");
            SceneParts.Subscribe(scan, "/scan", "sensor_msgs/msg/LaserScan");
            Finish(scan.AddComponent<LaserScanDisplay>(), command);
        }

        /// <summary>A cloud of points.</summary>
        [MenuItem(Path + "Point Cloud", false, Priority)]
        public static void PointCloud(MenuCommand command)
        {
            GameObject cloud = new GameObject("Point Cloud");
            SceneParts.Subscribe(cloud, "/points", "sensor_msgs/msg/PointCloud2");
            Finish(cloud.AddComponent<PointCloudDisplay>(), command);
        }

        /// <summary>A battery's charge, as text.</summary>
        [MenuItem(Path + "Battery", false, Priority)]
        public static void Battery(MenuCommand command)
        {
            GameObject battery = Text("Battery");
            SceneParts.Subscribe(battery, "/battery_state", "sensor_msgs/msg/BatteryState");
            Finish(battery.AddComponent<BatteryDisplay>(), command);
        }

        /// <summary>The arrow keys drive.</summary>
        [MenuItem(Path + "Teleop Driver", false, Priority)]
        public static void Teleop(MenuCommand command)
        {
            Finish(new GameObject("Teleop Driver", typeof(TeleopDriver)), command);
        }

        /// <summary>A point of the scene is driven to.</summary>
        [MenuItem(Path + "Target Driver", false, Priority)]
        public static void Target(MenuCommand command)
        {
            Finish(new GameObject("Target Driver", typeof(TargetDriver)), command);
        }

        internal static GameObject Text(string name)
        {
            GameObject made = new GameObject(name);
            SceneParts.AddText(made);
            return made;
        }

        internal static void Finish(Component on, MenuCommand command)
        {
            Finish(on.gameObject, command);
        }

        private static void Finish(GameObject made, MenuCommand command)
        {
            GameObjectUtility.SetParentAndAlign(made, command.context as GameObject);
            Undo.RegisterCreatedObjectUndo(made, "Create " + made.name);
            Selection.activeObject = made;
        }
    }
}
