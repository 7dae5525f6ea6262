// SPDX-License-Identifier: Apache-2.0
using System.Collections;
using NUnit.Framework;
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Messages.NavMsgs;
using Ros2Gateway.Messages.SensorMsgs;
using UnityEngine;
using UnityEngine.TestTools;

namespace Ros2Gateway.Unity.Tests
{
    /// <summary>Every display with what the simulated robot says.</summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class LiveDisplaysTests
    {
        private DisplayScene _scene;

        [SetUp]
        public void SetUp()
        {
            _scene = new DisplayScene();
            _scene.Connect();
        }

        [TearDown]
        public void TearDown() => _scene.Dispose();

        [UnityTest]
        public IEnumerator TheCameraIsOnTheScreen()
        {
            ImageScreen screen = _scene.Display<ImageScreen>(
                "/camera/image_raw/compressed", "8", DisplayParts.OnRenderer);
            yield return _scene.Until(() => !screen.IsStale, "for a picture");
            Assert.Greater(screen.Texture.width, 0);
            Assert.AreEqual(TextureFormat.RGBA32, screen.Texture.format, "not decoded by Unity");
        }

        [UnityTest]
        public IEnumerator TheCameraIsOnTheScreenWithMessagesThatAreFilledAnew()
        {
            ImageScreen screen = _scene.Display<ImageScreen>("/camera/image_raw/compressed", "8", made =>
            {
                DisplayParts.OnRenderer(made);
                made.GetComponent<TopicSubscriber>().Reuse = true;
            });
            yield return _scene.Until(() => !screen.IsStale, "for a picture");
            Assert.IsInstanceOf<Ros2Gateway.Pictures.PictureMsg>(screen.Subscriber.Last);
            Assert.AreEqual(TextureFormat.RGBA32, screen.Texture.format);
            Assert.IsFalse(_scene.HasLogged("carries"), "which the screen would not know");
        }

        [UnityTest]
        public IEnumerator ListenersThatThrowKeepNoPictureFromTheScreen()
        {
            LogAssert.ignoreFailingMessages = true; // that they are told is the point
            int arrived = 0;
            int received = 0;
            ImageScreen screen = _scene.Display<ImageScreen>("/camera/image_raw/compressed", "8", made =>
            {
                DisplayParts.OnRenderer(made);
                made.OnStale.AddListener(isStale => { throw new System.InvalidOperationException("by stale"); });
                TopicSubscriber subscriber = made.GetComponent<TopicSubscriber>();
                subscriber.MessageArriving += message => { throw new System.InvalidOperationException("by arrival"); };
                subscriber.MessageArriving += message => System.Threading.Interlocked.Increment(ref arrived);
                subscriber.MessageReceived += message => received++;
            });
            yield return _scene.Until(() => !screen.IsStale && received >= 10, "for pictures");
            Assert.GreaterOrEqual(arrived, 10);
            const string Arriving = "listener of MessageArriving of TopicSubscriber on ImageScreen threw InvalidOperationException";
            yield return _scene.Until(() => _scene.HasLogged(Arriving + ", 10 times by now: by arrival"), "for the count");
            Assert.AreEqual(1, _scene.Logged.FindAll(text => text.Contains(Arriving + ": by arrival")).Count);
            Assert.IsTrue(_scene.HasLogged("listener of On Stale of ImageScreen on ImageScreen threw"));
            Assert.IsFalse(_scene.HasLogged("cannot be read"));
        }

        [UnityTest]
        public IEnumerator PicturesComeAsLargeAsTheCameraSeesThem()
        {
            ImageScreen screen = _scene.Display<ImageScreen>(
                "/camera/image_raw", "sensor_msgs/msg/Image", DisplayParts.OnRenderer);
            yield return _scene.Until(() => !screen.IsStale, "for a picture");
            Assert.Greater(screen.Texture.width, 160);
            Camera camera = _scene.Inactive("camera").AddComponent<Camera>();
            camera.tag = "MainCamera";
            camera.transform.position = new Vector3(0, 0, -20);
            camera.gameObject.SetActive(true);
            yield return _scene.Until(() => screen.Texture.width == 160, "for small pictures");
            Object.Destroy(camera.gameObject);
            yield return _scene.Until(() => screen.Texture.width > 160, "for large ones again");
        }

        [UnityTest]
        public IEnumerator AnyTopicIsText()
        {
            TextScreen screen = _scene.Display<TextScreen>("/scan", "");
            yield return _scene.Until(
                () => screen.Output.Text != null && screen.Output.Text.Contains("... 360]"), "for a scan");
            StringAssert.Contains("range_max: 3.5", screen.Output.Text);
        }

        [UnityTest]
        public IEnumerator TheTwinFollowsTheRobot()
        {
            DigitalTwin twin = _scene.Display<DigitalTwin>("/odom", OdometryMsg.Type);
            TopicPublisher driver = _scene.Publisher("/cmd_vel", TwistMsg.Type);
            TwistMsg turn = new();
            turn.angular.z = 0.5;
            yield return _scene.Until(() => twin.Subscriber.Last != null, "for odometry");
            yield return null;
            Quaternion before = twin.transform.localRotation;
            // Another test may have left the robot stopped: zeros count as fresh after a second.
            System.Diagnostics.Stopwatch letGo = System.Diagnostics.Stopwatch.StartNew();
            yield return _scene.Until(
                () => letGo.ElapsedMilliseconds > 1500,
                "for the robot to be let go",
                () => driver.Publish(new TwistMsg()));
            yield return _scene.Until(
                () => Quaternion.Angle(before, twin.transform.localRotation) > 5,
                "to turn",
                () =>
                {
                    if (!driver.Publish(turn))
                    {
                        driver.Publish(new TwistMsg()); // this stood still for so long that the robot was stopped
                    }
                });
            driver.Publish(new TwistMsg());
        }

        [UnityTest]
        public IEnumerator TheScanIsDrawn()
        {
            LaserScanDisplay display = _scene.Display<LaserScanDisplay>("/scan", LaserScanMsg.Type);
            yield return _scene.Until(() => display.Hits > 10, "for hits");
            Bounds bounds = display.GetComponent<MeshFilter>().sharedMesh.bounds;
            Assert.Less(bounds.size.magnitude, 10, "the scanner reaches 3.5 m");
            Assert.AreEqual(0, bounds.size.y, "the scan is flat");
        }

        [UnityTest]
        public IEnumerator APointCloudIsDrawn()
        {
            PointCloudDisplay display = _scene.Display<PointCloudDisplay>("/cloud", PointCloud2Msg.Type);
            GatewayClient client = _scene.Connection.Client;
            Publisher<PointCloud2Msg> publisher = client.Advertise<PointCloud2Msg>("/cloud");
            PointCloud2Msg cloud = new()
            {
                width = 500,
                height = 2,
                point_step = 12,
                row_step = 6000,
                data = new byte[12000],
                fields = new[]
                {
                    new PointFieldMsg { name = "x", datatype = PointFieldMsg.FLOAT32, count = 1 },
                    new PointFieldMsg { name = "y", datatype = PointFieldMsg.FLOAT32, count = 1, offset = 4 },
                    new PointFieldMsg { name = "z", datatype = PointFieldMsg.FLOAT32, count = 1, offset = 8 },
                },
            };
            yield return _scene.Until(() => client.IsConnected, "to be connected");
            yield return _scene.Until(
                () => display.Drawn == 1000, "for the points", () => publisher.Publish(cloud, evenLate: true));
        }

        [UnityTest]
        public IEnumerator TheBatteryIsShown()
        {
            BatteryDisplay display = _scene.Display<BatteryDisplay>("/battery_state", "6");
            yield return _scene.Until(() => display.Output.Text != null, "for the battery");
            StringAssert.Contains(" %, ", display.Output.Text);
            Assert.IsFalse(display.IsLow);
        }
    }
}
