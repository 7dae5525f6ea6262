// SPDX-License-Identifier: Apache-2.0
using System.Collections;
using NUnit.Framework;
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Messages.NavMsgs;
using UnityEngine;
using UnityEngine.TestTools;

namespace Ros2Gateway.Unity.Tests
{
    /// <summary>Maps, paths, poses and trails.</summary>
    [TestFixture]
    public sealed class MapDisplaysTests
    {
        private const float Tolerance = 1e-5f;

        private DisplayScene _scene;

        [SetUp]
        public void SetUp() => _scene = new DisplayScene();

        [TearDown]
        public void TearDown() => _scene.Dispose();

        [UnityTest]
        public IEnumerator AMapLiesOnTheGroundFromItsOrigin()
        {
            OccupancyGridDisplay display = _scene.Display<OccupancyGridDisplay>(setUp: made => made.Height = 0.01f);
            OccupancyGridMsg grid = Grid(3, 2, 0, 100, 100, -1, 0, 0);
            grid.info.origin.position.x = -1;
            grid.info.origin.position.y = 2;
            display.Show(grid);
            yield return null;
            Mesh mesh = MeshOf(display);
            AreClose(new Vector3(-2, 0.01f, -1), mesh.vertices[0]);
            AreClose(new Vector3(-2, 0.01f, 0.5f), mesh.vertices[1]); // three cells along x of ROS
            AreClose(new Vector3(-3, 0.01f, 0.5f), mesh.vertices[2]);
            Assert.AreEqual(new Vector2(1, 1), mesh.uv[2]);
            Vector3 normal = Vector3.Cross(
                mesh.vertices[mesh.triangles[1]] - mesh.vertices[mesh.triangles[0]],
                mesh.vertices[mesh.triangles[2]] - mesh.vertices[mesh.triangles[0]]);
            Assert.Greater(normal.y, 0, "its front is above");
            Color32[] pixels = display.Texture.GetPixels32();
            Assert.AreEqual(255, pixels[0].r);
            Assert.AreEqual(0, pixels[1].r);
            Assert.AreEqual(112, pixels[3].r);
            Assert.AreSame(display.Texture, display.GetComponent<MeshRenderer>().sharedMaterial.mainTexture);
        }

        [UnityTest]
        public IEnumerator AMapMayGrowAndGetOtherColours()
        {
            OccupancyGridDisplay display = _scene.Display<OccupancyGridDisplay>();
            display.Show(Grid(1, 1, 0));
            yield return null;
            display.Colors = Maps.OccupancyGridColors.Costmap;
            display.Show(Grid(2, 2, 0, 0, 0, 100));
            yield return null;
            Assert.AreEqual(2, display.Texture.width);
            Assert.AreEqual(0, display.Texture.GetPixels32()[0].a);
            Assert.AreEqual(255, display.Texture.GetPixels32()[3].b);
        }

        [UnityTest]
        public IEnumerator AMaterialOfTheProjectStaysAsItIs()
        {
            Material chosen = new(Shader.Find("Sprites/Default"));
            GameObject holder = _scene.Inactive("map");
            holder.AddComponent<MeshRenderer>().sharedMaterial = chosen;
            OccupancyGridDisplay display = holder.AddComponent<OccupancyGridDisplay>();
            holder.SetActive(true);
            display.Show(Grid(1, 1, 0));
            yield return null;
            Assert.IsNull(chosen.mainTexture);
            Assert.AreSame(display.Texture, holder.GetComponent<MeshRenderer>().sharedMaterial.mainTexture);
        }

        [UnityTest]
        public IEnumerator ABrokenMapIsToldAndNotDrawn()
        {
            LogAssert.Expect(LogType.Warning, new System.Text.RegularExpressions.Regex("must have 2 by 2"));
            LogAssert.Expect(LogType.Warning, new System.Text.RegularExpressions.Regex("origin is not finite"));
            OccupancyGridDisplay display = _scene.Display<OccupancyGridDisplay>();
            display.Show(Grid(2, 2, 1));
            yield return null;
            Assert.AreEqual(0, MeshOf(display).vertexCount);
            Assert.IsTrue(float.IsInfinity(display.AgeSeconds));
            OccupancyGridMsg grid = Grid(1, 1, 0);
            grid.info.origin.position.x = double.NaN;
            display.Show(grid);
            yield return null;
            Assert.AreEqual(0, MeshOf(display).vertexCount);
        }

        [UnityTest]
        public IEnumerator APathIsALineWithGapsWhereItIsNotFinite()
        {
            LogAssert.Expect(LogType.Warning, new System.Text.RegularExpressions.Regex("the line has a gap"));
            PathDisplay display = _scene.Display<PathDisplay>();
            PathMsg path = new()
            {
                poses = new[] { At(0, 0), At(1, 0), At(double.NaN, 0), At(2, 0), At(2, 1), null, At(double.MaxValue, 0) },
            };
            display.Show(path);
            yield return null;
            Assert.AreEqual(4, display.Drawn);
            Assert.AreEqual(MeshTopology.Lines, MeshOf(display).GetTopology(0));
            CollectionAssert.AreEqual(new[] { 0, 1, 2, 3 }, MeshOf(display).GetIndices(0));
            AreClose(new Vector3(-1, 0, 2), MeshOf(display).vertices[3]);
        }

        [UnityTest]
        public IEnumerator AnEmptyPathTakesTheOldOneAway()
        {
            PathDisplay display = _scene.Display<PathDisplay>();
            display.Show(new PathMsg { poses = new[] { At(0, 0), At(1, 0) } });
            yield return null;
            Assert.AreEqual(2, MeshOf(display).vertexCount);
            display.Show(new PathMsg { poses = null });
            yield return null;
            Assert.AreEqual(0, MeshOf(display).vertexCount);
        }

        [UnityTest]
        public IEnumerator APathOfEndlessPosesIsThinnedOut()
        {
            PathDisplay display = _scene.Display<PathDisplay>();
            PoseStampedMsg[] poses = new PoseStampedMsg[200000];
            for (int i = 0; i < poses.Length; i++)
            {
                poses[i] = At(i, 0);
            }
            display.Show(new PathMsg { poses = poses });
            yield return null;
            Assert.AreEqual(50000, display.Drawn);
        }

        [UnityTest]
        public IEnumerator APoseIsAnArrowOfItsLength()
        {
            PoseDisplay display = _scene.Display<PoseDisplay>(setUp: made => made.Length = 2);
            PoseStampedMsg pose = At(1, 0);
            pose.pose.orientation.w = 1;
            display.Show(pose);
            yield return null;
            Bounds bounds = MeshOf(display).bounds;
            AreClose(new Vector3(0, 0, 2), bounds.center);
            Assert.AreEqual(2, bounds.size.z, Tolerance);
        }

        [UnityTest]
        public IEnumerator APoseThatIsNotFiniteIsToldAndNotDrawn()
        {
            LogAssert.Expect(LogType.Warning, new System.Text.RegularExpressions.Regex("the pose is not finite"));
            PoseDisplay display = _scene.Display<PoseDisplay>();
            display.Show(At(double.PositiveInfinity, 0));
            yield return null;
            Assert.AreEqual(0, MeshOf(display).vertexCount);
        }

        [UnityTest]
        public IEnumerator PosesOfAnArrayAreArrowsAsManyAsFit()
        {
            LogAssert.Expect(LogType.Warning, new System.Text.RegularExpressions.Regex("some of the poses are not finite"));
            LogAssert.Expect(LogType.Warning, new System.Text.RegularExpressions.Regex("too many poses"));
            PoseArrayDisplay display = _scene.Display<PoseArrayDisplay>();
            display.Show(new PoseArrayMsg { poses = new[] { At(0, 0).pose, At(double.NaN, 0).pose, null, At(1, 1).pose } });
            yield return null;
            Assert.AreEqual(2, display.Drawn);
            PoseMsg[] many = new PoseMsg[10000];
            for (int i = 0; i < many.Length; i++)
            {
                many[i] = At(i, 0).pose;
            }
            display.Show(new PoseArrayMsg { poses = many });
            yield return null;
            Assert.Greater(display.Drawn, 5000);
            Assert.Less(display.Drawn, 10000);
        }

        [UnityTest]
        public IEnumerator ATrailKeepsTheNewestPlaces()
        {
            OdometryTrail trail = _scene.Display<OdometryTrail>(setUp: made =>
            {
                made.MaxPoints = 3;
                made.Spacing = 0.5f;
            });
            foreach (float x in new[] { 0, 0.1f, 0.6f, 1.2f, 1.8f })
            {
                trail.Show(Odometry(x));
                yield return null;
            }
            Assert.AreEqual(3, trail.Count); // 0 made room, 0.1 is too near
            AreClose(new Vector3(0, 0, 0.6f), MeshOf(trail).vertices[0]);
            AreClose(new Vector3(0, 0, 1.8f), MeshOf(trail).vertices[2]);
            CollectionAssert.AreEqual(new[] { 0, 1, 1, 2 }, MeshOf(trail).GetIndices(0));
            trail.Show(Odometry(5));
            yield return null;
            Assert.AreEqual(1, trail.Count, "a jump begins a new trail");
            trail.Show(Odometry(5.6f));
            yield return null;
            Assert.AreEqual(2, trail.Count);
            OdometryMsg other = Odometry(5.7f);
            other.header.frame_id = "other";
            trail.Show(other);
            yield return null;
            Assert.AreEqual(1, trail.Count, "another frame, too");
        }

        [UnityTest]
        [Category("Gateway")]
        [Category("Inflates")]
        public IEnumerator TheRobotsMapIsDrawn()
        {
            _scene.Connect();
            IMessage arrived = null;
            OccupancyGridDisplay display = _scene.Display<OccupancyGridDisplay>(
                "/map", OccupancyGridMsg.Type,
                made => made.GetComponent<TopicSubscriber>().MessageArriving += message => arrived = message);
            yield return _scene.Until(() => display.Texture != null, "for the map");
            Assert.AreSame(arrived, display.Subscriber.Last);
            OccupancyGridMsg map = (OccupancyGridMsg)display.Subscriber.Last;
            Assert.AreEqual(map.info.width, display.Texture.width);
            Assert.AreEqual(map.info.height * map.info.resolution, MeshOf(display).bounds.size.x, 0.001f);
        }

        [UnityTest]
        [Category("Gateway")]
        [Category("Inflates")]
        public IEnumerator AMapThatCameBeforeItsDisplayWasEnabledIsDrawn()
        {
            _scene.Connect();
            OccupancyGridDisplay display = _scene.Display<OccupancyGridDisplay>(
                "/map", OccupancyGridMsg.Type, made => made.enabled = false);
            TopicSubscriber subscriber = display.GetComponent<TopicSubscriber>();
            yield return _scene.Until(() => subscriber.Last != null, "for the map");
            float cameAt = subscriber.LastTime;
            yield return null;
            Assert.IsNull(display.Texture);
            display.enabled = true;
            yield return null;
            yield return null;
            Assert.AreEqual(cameAt, subscriber.LastTime, "the map is published once");
            Assert.IsNotNull(display.Texture);
            Assert.AreEqual(Time.unscaledTime - cameAt, display.AgeSeconds, 1e-3f);
        }

        [UnityTest]
        [Category("Gateway")]
        [Category("Inflates")]
        public IEnumerator WhatIsShownByHandIsNotReplacedByWhatCameBefore()
        {
            _scene.Connect();
            OccupancyGridDisplay display = _scene.Display<OccupancyGridDisplay>(
                "/map", OccupancyGridMsg.Type, made => made.enabled = false);
            TopicSubscriber subscriber = display.GetComponent<TopicSubscriber>();
            yield return _scene.Until(() => subscriber.Last != null, "for the map");
            display.enabled = true;
            display.Show(Grid(1, 1, 0));
            yield return null;
            yield return null;
            Assert.AreEqual(1, display.Texture.width);
        }

        [UnityTest]
        [Category("Gateway")]
        [Category("Inflates")]
        public IEnumerator NorIsWhatIsShownByHandWhileTheDisplayIsDisabled()
        {
            _scene.Connect();
            OccupancyGridDisplay display = _scene.Display<OccupancyGridDisplay>(
                "/map", OccupancyGridMsg.Type, made => made.enabled = false);
            TopicSubscriber subscriber = display.GetComponent<TopicSubscriber>();
            yield return _scene.Until(() => subscriber.Last != null, "for the map");
            display.Show(Grid(1, 1, 0));
            display.enabled = true;
            yield return null;
            yield return null;
            Assert.AreEqual(1, display.Texture.width);
        }

        [UnityTest]
        [Category("Gateway")]
        [Category("Inflates")]
        public IEnumerator WhatAnotherGatewaySentIsNotShown()
        {
            _scene.Connect();
            OccupancyGridDisplay display = _scene.Display<OccupancyGridDisplay>(
                "/map", OccupancyGridMsg.Type, made => made.enabled = false);
            TopicSubscriber subscriber = display.GetComponent<TopicSubscriber>();
            yield return _scene.Until(() => subscriber.Last != null, "for the map");
            string silent = System.Environment.GetEnvironmentVariable("ROS2GATEWAY_ROGUE_URL") + "/assets";
            _scene.Connect(made => made.Address = silent);
            subscriber.Connection = _scene.Connection;
            display.enabled = true;
            yield return null;
            yield return null;
            Assert.IsNull(display.Texture);
        }

        private static OccupancyGridMsg Grid(uint width, uint height, params sbyte[] cells)
        {
            OccupancyGridMsg grid = new() { data = cells };
            grid.info.width = width;
            grid.info.height = height;
            grid.info.resolution = 0.5f;
            return grid;
        }

        private static PoseStampedMsg At(double x, double y)
        {
            PoseStampedMsg pose = new();
            pose.pose.position.x = x;
            pose.pose.position.y = y;
            return pose;
        }

        private static OdometryMsg Odometry(float x)
        {
            OdometryMsg odometry = new();
            odometry.pose.pose.position.x = x;
            return odometry;
        }

        private static Mesh MeshOf(Component display) => display.GetComponent<MeshFilter>().sharedMesh;

        private static void AreClose(Vector3 expected, Vector3 actual) =>
            Assert.Less(Vector3.Distance(expected, actual), Tolerance, expected + " and " + actual);
    }
}
