// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections;
using System.Diagnostics;
using System.Text.RegularExpressions;
using NUnit.Framework;
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Messages.NavMsgs;
using Ros2Gateway.Messages.SensorMsgs;
using Ros2Gateway.Messages.StdMsgs;
using Ros2Gateway.Unity;
using UnityEngine;
using UnityEngine.Stage;
using UnityEngine.TestTools;
using Object = UnityEngine.Object;

namespace Ros2Gateway.Play.Tests
{
    /// <summary>Scripts that are compiled again in Play, which goes on: the editor's default.</summary>
    [TestFixture]
    public sealed class ReloadScriptsTests
    {
        private const int TimeoutMilliseconds = 120000; // a machine may be busy with other things
        private const string Robot = "<robot name='arm'><link name='base'>"
            + "<visual><geometry><box size='1 2 3'/></geometry></visual></link><link name='upper'/>"
            + "<joint name='elbow' type='revolute'><parent link='base'/><child link='upper'/></joint></robot>";

        private GameObject _holder;

        [SetUp]
        public void SetUp()
        {
            _holder = new GameObject("scene");
        }

        [TearDown]
        public void TearDown()
        {
            Object.DestroyImmediate(_holder);
        }

        [UnityTest]
        public IEnumerator A_scan_is_drawn_on()
        {
            return IsDrawnOn<LaserScanDisplay, LaserScanMsg>(new LaserScanMsg { ranges = new[] { 1f, 2f } });
        }

        [UnityTest]
        public IEnumerator A_path_is_drawn_on()
        {
            return IsDrawnOn<PathDisplay, PathMsg>(
                new PathMsg { poses = new[] { new PoseStampedMsg(), new PoseStampedMsg() } });
        }

        [UnityTest]
        public IEnumerator A_pose_is_drawn_on()
        {
            return IsDrawnOn<PoseDisplay, PoseStampedMsg>(new PoseStampedMsg());
        }

        [UnityTest]
        public IEnumerator Poses_are_drawn_on()
        {
            return IsDrawnOn<PoseArrayDisplay, PoseArrayMsg>(new PoseArrayMsg { poses = new[] { new PoseMsg() } });
        }

        [UnityTest]
        public IEnumerator A_cloud_is_drawn_on()
        {
            return IsDrawnOn<PointCloudDisplay, PointCloud2Msg>(new PointCloud2Msg
            {
                width = 1,
                height = 1,
                point_step = 12,
                row_step = 12,
                data = new byte[12],
                fields = new[] { Field("x", 0), Field("y", 4), Field("z", 8) },
            });
        }

        [UnityTest]
        public IEnumerator A_map_is_drawn_on()
        {
            OccupancyGridMsg grid = new OccupancyGridMsg { data = new sbyte[] { 0 } };
            grid.info.width = grid.info.height = 1;
            grid.info.resolution = 1;
            return IsDrawnOn<OccupancyGridDisplay, OccupancyGridMsg>(grid);
        }

        [UnityTest]
        public IEnumerator A_trail_goes_on()
        {
            OdometryTrail trail = _holder.AddComponent<OdometryTrail>();
            for (int i = 0; i < 3; i++)
            {
                OdometryMsg odometry = new OdometryMsg();
                odometry.pose.pose.position.x = 0.1 * i;
                trail.Show(odometry);
                yield return null;
                PlayerLoop.ReloadScripts();
                Assert.AreEqual(i + 1, trail.Count);
                Assert.AreEqual(i + 1, MeshOf(trail).vertexCount);
            }
        }

        [UnityTest]
        public IEnumerator Depth_is_read_on()
        {
            DepthDisplay display = _holder.AddComponent<DepthDisplay>();
            yield return null;
            PlayerLoop.ReloadScripts();
            LogAssert.Expect(LogType.Warning, new Regex("not calibrated"));
            LogAssert.Expect(LogType.Warning, new Regex("set the subscriber's Image Format to png"));
            display.SetCamera(new CameraInfoMsg());
            display.Show(new CompressedImageMsg { data = new byte[] { 0xff, 0xd8, 0xff } });
            yield return null;
        }

        [UnityTest]
        public IEnumerator A_robot_is_built_once()
        {
            RobotDescriptionDisplay robot = _holder.AddComponent<RobotDescriptionDisplay>();
            robot.Show(new StringMsg { data = Robot });
            yield return null;
            PlayerLoop.ReloadScripts();
            robot.Show(new StringMsg { data = Robot });
            yield return null;
            yield return null; // objects go at the end of a frame
            Assert.IsTrue(robot.SetJoint("elbow", 1));
            Assert.AreEqual(2, robot.transform.childCount, "a link and a box");
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator Components_work_on()
        {
            _holder.SetActive(false);
            TopicSubscriber subscriber = _holder.AddComponent<TopicSubscriber>();
            subscriber.Topic = "/odom";
            subscriber.Type = OdometryMsg.Type;
            TeleopDriver driver = _holder.AddComponent<TeleopDriver>();
            TopicPublisher late = _holder.AddComponent<TopicPublisher>();
            late.enabled = false;
            GatewayConnection connection = _holder.AddComponent<GatewayConnection>();
            connection.Address = Environment.GetEnvironmentVariable("ROS2GATEWAY_TEST_URL");
            _holder.SetActive(true);
            for (int i = 0; i < 2; i++)
            {
                IMessage last = subscriber.Last;
                yield return Until(() => !ReferenceEquals(subscriber.Last, last), "for odometry after reload " + i);
                yield return Until(() => driver.CommandType != null, "for the robot after reload " + i);
                PlayerLoop.ReloadScripts();
            }
            late.enabled = true;
            Assert.AreSame(connection, late.Connection, "it was never to another address");
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator No_component_throws()
        {
            _holder.SetActive(false);
            GatewayConnection connection = _holder.AddComponent<GatewayConnection>();
            connection.Address = Environment.GetEnvironmentVariable("ROS2GATEWAY_TEST_URL");
            _holder.SetActive(true);
            foreach (Type type in typeof(GatewayConnection).Assembly.GetTypes())
            {
                if (typeof(MonoBehaviour).IsAssignableFrom(type) && !type.IsAbstract && type != typeof(GatewayConnection))
                {
                    new GameObject(type.Name, typeof(TextMesh), typeof(MeshRenderer), type)
                        .transform.SetParent(_holder.transform);
                }
            }
            string thrown = "";
            Application.LogCallback listen = (text, stack, kind) => thrown += kind == LogType.Exception ? text + stack : "";
            LogAssert.ignoreFailingMessages = true; // of topics of other types
            Application.logMessageReceived += listen;
            for (int i = 0; i < 3; i++)
            {
                yield return Until(() => connection.Client.IsConnected, "to be connected");
                for (int frames = 0; frames < 20; frames++)
                {
                    yield return null;
                }
                PlayerLoop.ReloadScripts();
            }
            Application.logMessageReceived -= listen;
            Assert.IsEmpty(thrown);
        }

        private IEnumerator IsDrawnOn<TDisplay, TMessage>(TMessage message)
            where TDisplay : TopicDisplay<TMessage>
            where TMessage : class, IMessage
        {
            TDisplay display = _holder.AddComponent<TDisplay>();
            display.Show(message);
            yield return null;
            int drawn = MeshOf(display).vertexCount;
            Assert.Greater(drawn, 0);
            PlayerLoop.ReloadScripts();
            MeshOf(display).Clear();
            display.Show(message);
            yield return null;
            Assert.AreEqual(drawn, MeshOf(display).vertexCount);
        }

        private static Mesh MeshOf(Component display)
        {
            return display.GetComponent<MeshFilter>().sharedMesh;
        }

        private static PointFieldMsg Field(string name, uint offset)
        {
            return new PointFieldMsg { name = name, offset = offset, datatype = PointFieldMsg.FLOAT32, count = 1 };
        }

        private static IEnumerator Until(Func<bool> holds, string what)
        {
            Stopwatch watch = Stopwatch.StartNew();
            while (!holds())
            {
                Assert.Less(watch.ElapsedMilliseconds, TimeoutMilliseconds, "waited in vain " + what);
                yield return null;
            }
        }
    }
}
