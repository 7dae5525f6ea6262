// SPDX-License-Identifier: Apache-2.0
using NUnit.Framework;
using Ros2Gateway.Unity;
using UnityEditor;
using UnityEngine;

namespace Ros2Gateway.Editor.Tests
{
    /// <summary>The menus make what they say.</summary>
    [TestFixture]
    public sealed class DisplaysMenuTests
    {
        [Test]
        public void TheMenuMakesDisplays()
        {
            GameObject parent = new("parent");
            parent.SetActive(false); // nothing in it begins
            MenuCommand command = new(parent);
            Made<TexturePublisher>(() => DisplaysMenu.Texture(command), parent);
            GameObject made = (GameObject)Selection.activeObject;
            Assert.AreEqual("sensor_msgs/msg/CompressedImage", made.GetComponent<TopicPublisher>().Type);
            Assert.AreSame(made.GetComponent<Camera>(), made.GetComponent<TexturePublisher>().Camera);
            Made<ImageScreen>(() => DisplaysMenu.ImageScreen(command), parent);
            Made<TextScreen>(() => DisplaysMenu.TextScreen(command), parent);
            Made<LogScreen>(() => DisplaysMenu.LogScreen(command), parent);
            Made<ConnectionHud>(() => DisplaysMenu.Hud(command), parent);
            Made<DigitalTwin>(() => DisplaysMenu.Twin(command), parent);
            Made<LaserScanDisplay>(() => DisplaysMenu.LaserScan(command), parent);
            Made<PointCloudDisplay>(() => DisplaysMenu.PointCloud(command), parent);
            Made<BatteryDisplay>(() => DisplaysMenu.Battery(command), parent);
            Made<TeleopDriver>(() => DisplaysMenu.Teleop(command), parent);
            Made<TargetDriver>(() => DisplaysMenu.Target(command), parent);
            Made<RobotRecorder>(() => DisplaysMenu.Recorder(command), parent);
            Object.DestroyImmediate(parent);
        }

        [Test]
        public void TheMenuMakesWhatStandsInFrames()
        {
            GameObject parent = new("parent");
            parent.SetActive(false);
            MenuCommand command = new(parent);
            Made<FixedFrame>(() => FramesMenu.FixedFrame(command), parent);
            Made<FrameFollower>(() => FramesMenu.FrameFollower(command), parent);
            Made<OccupancyGridDisplay>(() => FramesMenu.OccupancyGridDisplay(command), parent);
            Made<PathDisplay>(() => FramesMenu.PathDisplay(command), parent);
            Made<PoseDisplay>(() => FramesMenu.PoseDisplay(command), parent);
            Made<PoseArrayDisplay>(() => FramesMenu.PoseArrayDisplay(command), parent);
            Made<OdometryTrail>(() => FramesMenu.OdometryTrail(command), parent);
            Made<MarkerArrayDisplay>(() => FramesMenu.MarkerArrayDisplay(command), parent);
            Assert.Greater(((GameObject)Selection.activeObject).GetComponent<TopicSubscriber>().Queue, 1);
            Made<DepthDisplay>(() => FramesMenu.DepthDisplay(command), parent);
            Assert.AreEqual("png", ((GameObject)Selection.activeObject).GetComponent<TopicSubscriber>().ImageFormat);
            Made<GoalPosePublisher>(() => FramesMenu.GoalPosePublisher(command), parent);
            Made<NavigateToPose>(() => FramesMenu.NavigateToPose(command), parent);
            Object.DestroyImmediate(parent);
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
