// SPDX-License-Identifier: Apache-2.0
using NUnit.Framework;
using Ros2Gateway.Unity;
using UnityEditor;
using UnityEngine;
using UnityEngine.TestTools;

namespace Ros2Gateway.Editor.Tests
{
    /// <summary>The inspectors open, draw and close. The menu makes what it says.</summary>
    [TestFixture]
    public sealed class InspectorTests
    {
        [Test]
        public void InspectorsDrawWhereNothingIsConnected()
        {
            GameObject holder = new GameObject("topics");
            holder.SetActive(false);
            Draw(holder.AddComponent<GatewayConnection>(), typeof(GatewayConnectionInspector));
            Draw(holder.AddComponent<TopicSubscriber>(), typeof(TopicSubscriberInspector));
            Draw(holder.AddComponent<TopicPublisher>(), typeof(TopicPublisherInspector));
            Object.DestroyImmediate(holder);
            GatewaySettings settings = ScriptableObject.CreateInstance<GatewaySettings>();
            Draw(settings, typeof(GatewaySettingsInspector));
            Object.DestroyImmediate(settings);
        }

        [Test]
        public void TheMenuMakesWhatItSays()
        {
            LogAssert.ignoreFailingMessages = true; // the connection may look for a gateway at once
            GameObject parent = new GameObject("parent");
            parent.SetActive(false); // nothing in it begins
            MenuCommand command = new MenuCommand(parent);
            Made<GatewayConnection>(() => GatewayMenu.Connection(command), parent);
            Made<TopicSubscriber>(() => GatewayMenu.Subscriber(command), parent);
            Made<TopicPublisher>(() => GatewayMenu.Publisher(command), parent);
            Made<TexturePublisher>(() => GatewayMenu.Texture(command), parent);
            GameObject made = (GameObject)Selection.activeObject;
            Assert.AreEqual("sensor_msgs/msg/CompressedImage", made.GetComponent<TopicPublisher>().Type);
            Assert.AreSame(made.GetComponent<Camera>(), made.GetComponent<TexturePublisher>().Camera);
            Made<ImageScreen>(() => GatewayMenu.ImageScreen(command), parent);
            Made<TextScreen>(() => GatewayMenu.TextScreen(command), parent);
            Made<LogScreen>(() => GatewayMenu.LogScreen(command), parent);
            Made<ConnectionHud>(() => GatewayMenu.Hud(command), parent);
            Made<DigitalTwin>(() => GatewayMenu.Twin(command), parent);
            Made<LaserScanDisplay>(() => GatewayMenu.LaserScan(command), parent);
            Made<PointCloudDisplay>(() => GatewayMenu.PointCloud(command), parent);
            Made<BatteryDisplay>(() => GatewayMenu.Battery(command), parent);
            Made<TeleopDriver>(() => GatewayMenu.Teleop(command), parent);
            Made<TargetDriver>(() => GatewayMenu.Target(command), parent);
            Object.DestroyImmediate(parent);
        }

        [Test]
        public void TheMenuMakesWhatStandsInFrames()
        {
            GameObject parent = new GameObject("parent");
            parent.SetActive(false);
            MenuCommand command = new MenuCommand(parent);
            Made<FixedFrame>(() => FramesMenu.FixedFrame(command), parent);
            Made<FrameFollower>(() => FramesMenu.FrameFollower(command), parent);
            Made<OccupancyGridDisplay>(() => FramesMenu.OccupancyGridDisplay(command), parent);
            Made<PathDisplay>(() => FramesMenu.PathDisplay(command), parent);
            Made<PoseDisplay>(() => FramesMenu.PoseDisplay(command), parent);
            Made<PoseArrayDisplay>(() => FramesMenu.PoseArrayDisplay(command), parent);
            Made<OdometryTrail>(() => FramesMenu.OdometryTrail(command), parent);
            Made<MarkerArrayDisplay>(() => FramesMenu.MarkerArrayDisplay(command), parent);
            Assert.Greater(((GameObject)Selection.activeObject).GetComponent<TopicSubscriber>().Queue, 1);
            Made<RobotDescriptionDisplay>(() => FramesMenu.RobotDescriptionDisplay(command), parent);
            Assert.IsNotNull(((GameObject)Selection.activeObject).GetComponentInChildren<JointStateDisplay>(true));
            Made<DepthDisplay>(() => FramesMenu.DepthDisplay(command), parent);
            Assert.AreEqual("png", ((GameObject)Selection.activeObject).GetComponent<TopicSubscriber>().ImageFormat);
            Made<GoalPosePublisher>(() => FramesMenu.GoalPosePublisher(command), parent);
            Made<NavigateToPose>(() => FramesMenu.NavigateToPose(command), parent);
            Object.DestroyImmediate(parent);
        }

        private static void Draw(Object target, System.Type inspector)
        {
            UnityEditor.Editor editor = UnityEditor.Editor.CreateEditor(target, inspector);
            editor.OnInspectorGUI();
            Object.DestroyImmediate(editor);
        }

        private static void Made<T>(System.Action make, GameObject parent)
            where T : Component
        {
            make();
            GameObject made = (GameObject)Selection.activeObject;
            Assert.IsNotNull(made.GetComponent<T>());
            Assert.AreSame(parent.transform, made.transform.parent);
        }
    }
}
