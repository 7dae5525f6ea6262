// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections;
using System.Collections.Generic;
using System.Threading;
using NUnit.Framework;
using Ros2Gateway.Messages.StdMsgs;
using UnityEngine;
using UnityEngine.Rendering;
using UnityEngine.TestTools;
using Object = UnityEngine.Object;

namespace Ros2Gateway.Unity.Tests
{
    /// <summary>
    /// Meshes of a robot that its gateway serves. The file package://rogue/N.stl has N triangles. For the nth fetch
    /// their corners are (0, 0, n), (1, 0, n) and (0, 2, n). The file red.dae has the triangle of 1, in red.
    /// </summary>
    [TestFixture]
    public sealed class ServedMeshesTests
    {
        private const string Rogue = "ROS2GATEWAY_ROGUE_URL";
        private const int BoxVertices = 24;

        private DisplayScene _scene;

        [SetUp]
        public void SetUp() => _scene = new DisplayScene();

        [TearDown]
        public void TearDown() => _scene.Dispose();

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator AServedMeshReplacesTheSmallBox()
        {
            Connect();
            RobotDescriptionDisplay robot = Robot(
                "<origin xyz='10 0 0'/><geometry><mesh filename='package://rogue/1.stl' scale='2 3 4'/></geometry>"
                + "<material name='red'><color rgba='1 0 0 1'/></material>");
            yield return null;
            Assert.AreEqual(BoxVertices, Shown(robot, 0).vertexCount, "until the mesh has come");
            Mesh mesh = Shown(robot, 0);
            yield return _scene.Until(() => mesh.vertexCount != BoxVertices, "for the mesh");
            Vector3[] expected = { new Vector3(0, 4, 10), new Vector3(0, 4, 12), new Vector3(-6, 4, 10) };
            CollectionAssert.AreEqual(expected, mesh.vertices);
            CollectionAssert.AreEqual(new[] { 0, 2, 1 }, mesh.GetIndices(0));
            Assert.AreEqual(new Color32(248, 0, 0, 255), mesh.colors32[0], "lit from above");
            Assert.AreSame(mesh, Shown(robot, 0));
            Assert.AreEqual(1, robot.transform.childCount);
            Assert.AreEqual(0, _scene.Connection.Client.PendingRequests);
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator AColladaFileHasItsOwnColours()
        {
            Connect();
            RobotDescriptionDisplay robot = Robot(
                Mesh("package://rogue/red.dae") + "<material name='blue'><color rgba='0 0 1 1'/></material>");
            yield return null;
            yield return _scene.Until(() => Shown(robot, 0).vertexCount == 3, "for the mesh");
            CollectionAssert.AreEqual(
                new[] { new Vector3(0, 1, 0), new Vector3(0, 1, 1), new Vector3(-2, 1, 0) }, Shown(robot, 0).vertices);
            Assert.AreEqual(new Color32(248, 0, 0, 255), Shown(robot, 0).colors32[0], "lit from above");
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator WhatIsRefusedIsAskedForAgainAfterTheOthers()
        {
            LogAssert.ignoreFailingMessages = true; // the client says what was refused
            Connect();
            RobotDescriptionDisplay robot = Robot(Mesh("package://rogue/busy.stl"), Mesh("package://rogue/2.stl"));
            yield return null;
            yield return _scene.Until(() => All(robot, mesh => mesh.vertexCount != BoxVertices), "for the meshes");
            Assert.AreEqual(2, Shown(robot, 1).vertices[0].y, "of the second fetch");
            Assert.AreEqual(3, Shown(robot, 0).vertices[0].y, "of the third");
            Assert.IsFalse(_scene.HasLogged("cannot be fetched"));
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator AFileIsFetchedOnceForAllThatShowItAndMirroredForOne()
        {
            Connect();
            RobotDescriptionDisplay robot = Robot(
                Mesh("package://rogue/1.stl"), Mesh("package://rogue/2.stl"), Mesh("package://rogue/1.stl", "1 -1 1"));
            yield return null;
            yield return _scene.Until(() => All(robot, mesh => mesh.vertexCount != BoxVertices), "for the meshes");
            Assert.AreEqual(new Vector3(0, 1, 0), Shown(robot, 0).vertices[0], "of the first fetch");
            Assert.AreEqual(new Vector3(0, 2, 0), Shown(robot, 1).vertices[0], "of the second");
            Vector3[] mirrored = { new Vector3(0, 1, 0), new Vector3(0, 1, 1), new Vector3(2, 1, 0) };
            CollectionAssert.AreEqual(mirrored, Shown(robot, 2).vertices, "of the first");
            CollectionAssert.AreEqual(new[] { 0, 1, 2 }, Shown(robot, 2).GetIndices(0), "the front stays above");
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator ALargeMeshIsDrawnInPartsThatGoWithTheRobot()
        {
            Connect();
            RobotDescriptionDisplay robot = Robot(Mesh("package://rogue/65537.STL"), Mesh("package://rogue/2.stl"));
            yield return null;
            yield return _scene.Until(
                () => robot.transform.childCount == 3 && Shown(robot, 1).vertexCount == 6, "for three parts");
            Assert.AreEqual(3 * 65536, Shown(robot, 0).vertexCount);
            Assert.AreEqual(IndexFormat.UInt32, Shown(robot, 0).indexFormat);
            Assert.AreEqual(3, Shown(robot, 2).vertexCount);
            Assert.AreSame(
                robot.transform.GetChild(0).GetComponent<MeshRenderer>().sharedMaterial,
                robot.transform.GetChild(2).GetComponent<MeshRenderer>().sharedMaterial);
            Mesh[] parts = { Shown(robot, 0), Shown(robot, 1), Shown(robot, 2) };
            Show(robot);
            yield return null;
            yield return null; // objects go at the end of a frame
            Assert.AreEqual(0, robot.transform.childCount);
            Assert.IsTrue(Array.TrueForAll(parts, part => part == null), "memory of the GPU is given back");
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator WhatCannotBeFetchedOrReadStaysASmallBoxAndIsSaidOnce()
        {
            LogAssert.ignoreFailingMessages = true; // the client says what was refused as well
            Connect();
            RobotDescriptionDisplay robot = Robot(
                Mesh("package://rogue/missing.stl"), Mesh("package://rogue/broken.stl"), Mesh("package://rogue/1.stl", "3e38 3e38 3e38"),
                Mesh("package://rogue/missing.stl"), Mesh("package://rogue/broken.stl"), Mesh("package://rogue/1.stl"));
            yield return null;
            yield return _scene.Until(() => Shown(robot, 5).vertexCount == 3, "for the only one that is right");
            yield return _scene.Until(() => _scene.HasLogged("missing.stl cannot be fetched"), "for the third refusal");
            for (int i = 0; i < 5; i++)
            {
                Assert.AreEqual(BoxVertices, Shown(robot, i).vertexCount, "of " + i);
            }
            const string Warning = "RobotDescriptionDisplay on RobotDescriptionDisplay: package://rogue/";
            List<string> warnings = _scene.Logged.FindAll(text => text.StartsWith(Warning));
            Assert.AreEqual(3, warnings.Count, string.Join(" | ", warnings));
            StringAssert.Contains("broken.stl cannot be drawn: the STL has 133 bytes", warnings[0]);
            StringAssert.Contains("1.stl cannot be drawn: with its scale", warnings[1]);
            StringAssert.Contains(
                "missing.stl cannot be fetched: there is no file package://rogue/missing.stl: a small box", warnings[2]);
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator AnotherDescriptionEndsWhatIsFetchedForTheFormer()
        {
            GatewayClient client = Connect();
            RobotDescriptionDisplay robot = Robot(Mesh("package://rogue/held.stl"), Mesh("package://rogue/2.stl"));
            yield return _scene.Until(() => client.PendingRequests == 1, "for the fetch");
            Show(robot, Mesh("package://rogue/3.stl"), Mesh("package://rogue/2.stl")); // the answer to the former comes first
            yield return null;
            yield return _scene.Until(
                () => robot.transform.childCount == 2 && All(robot, mesh => mesh.vertexCount != BoxVertices), "for the meshes");
            Assert.AreEqual(9, Shown(robot, 0).vertexCount);
            Assert.AreEqual(2, Shown(robot, 0).vertices[0].y, "of the second fetch");
            Assert.AreEqual(6, Shown(robot, 1).vertexCount);
            Assert.AreEqual(3, Shown(robot, 1).vertices[0].y, "of the third: what waited for the former is not fetched");
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator ADisplayThatIsDestroyedFetchesNoMore()
        {
            GatewayClient client = Connect();
            RobotDescriptionDisplay robot = Robot(Mesh("package://rogue/held.stl"), Mesh("package://rogue/2.stl"));
            yield return _scene.Until(() => client.PendingRequests == 1, "for the fetch");
            Object.DestroyImmediate(robot.gameObject);
            Assert.AreEqual(0, client.PendingRequests);
            RobotDescriptionDisplay other = Robot(Mesh("package://rogue/2.stl"));
            yield return null;
            yield return _scene.Until(() => Shown(other, 0).vertexCount == 6, "for the other's mesh");
            Assert.AreEqual(2, Shown(other, 0).vertices[0].y, "of the second fetch");
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator AConnectionThatComesLateAndIsLostIsWaitedFor()
        {
            LogAssert.ignoreFailingMessages = true; // the client says what was lost
            RobotDescriptionDisplay robot = Robot(Mesh("package://rogue/cut.stl"), Mesh("package://rogue/2.stl"));
            yield return null;
            Assert.IsTrue(_scene.HasLogged(
                "no model for package://rogue/cut.stl among Models, and no Gateway Connection to fetch it: a small box"));
            Connect();
            yield return _scene.Until(() => All(robot, mesh => mesh.vertexCount != BoxVertices), "for the meshes");
            Assert.AreEqual(1, Shown(robot, 0).vertices[0].y, "of the first fetch of the second connection");
            Assert.IsFalse(_scene.HasLogged("cannot be fetched"));
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator AConnectionThatIsLostAndBackWithinAFrameIsNoRefusal()
        {
            LogAssert.ignoreFailingMessages = true; // the client says what was lost
            GatewayClient client = Connect();
            RobotDescriptionDisplay robot = Robot(Mesh("package://rogue/held.stl"), Mesh("package://rogue/2.stl"));
            yield return _scene.Until(() => client.PendingRequests == 1, "for the fetch");
            client.Request("cut", null, null);
            Wait(() => client.PendingRequests == 0, "for the end");
            long frames = client.FramesReceived;
            Wait(() => client.FramesReceived > frames, "for the first answer of another connection");
            yield return _scene.Until(() => client.PendingRequests == 1, "for the fetch by that");
            client.FetchAsset("package://rogue/1.stl", null); // the answer to the other comes first
            yield return _scene.Until(() => All(robot, mesh => mesh.vertexCount != BoxVertices), "for the meshes");
            Assert.AreEqual(1, Shown(robot, 0).vertices[0].y, "of the first fetch: its turn is not over");
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator AnotherConnectionGoesOnWhereOneIsDestroyed()
        {
            LogAssert.ignoreFailingMessages = true; // the client says that the fetch has ended
            GatewayClient first = Connect();
            RobotDescriptionDisplay robot = Robot(Mesh("package://rogue/held.stl"));
            yield return _scene.Until(() => first.PendingRequests == 1, "for the fetch");
            Object.DestroyImmediate(_scene.Connection.gameObject);
            GatewayClient second = Connect();
            yield return _scene.Until(() => second.PendingRequests == 1, "for the fetch by the other");
            second.FetchAsset("package://rogue/1.stl", null); // the answer to the other comes first
            yield return _scene.Until(() => Shown(robot, 0).vertexCount == 3, "for the mesh");
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator AConnectionThatIsChosenMeanwhileIsTheOneToFetchBy()
        {
            GatewayClient first = Connect();
            RobotDescriptionDisplay robot = Robot(Mesh("package://rogue/held.stl"));
            yield return _scene.Until(() => first.PendingRequests == 1, "for the fetch");
            GatewayClient second = Connect();
            robot.Subscriber.Connection = _scene.Connection;
            yield return _scene.Until(() => second.PendingRequests == 1, "for the fetch by the other");
            Assert.AreEqual(0, first.PendingRequests);
            second.FetchAsset("package://rogue/1.stl", null); // the answer to the other comes first
            yield return _scene.Until(() => Shown(robot, 0).vertexCount == 3, "for the mesh");
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator AFileWithWhichThreeConnectionsEndedIsAskedForNoMore()
        {
            LogAssert.ignoreFailingMessages = true; // the client says what was lost
            int connections = 0;
            Connect().StateChanged += state => connections += state == ConnectionState.Connected ? 1 : 0;
            RobotDescriptionDisplay robot = Robot(Mesh("package://rogue/deadly.stl"), Mesh("package://rogue/2.stl"));
            yield return null;
            yield return _scene.Until(() => Shown(robot, 1).vertexCount == 6, "for the other mesh");
            Assert.AreEqual(BoxVertices, Shown(robot, 0).vertexCount);
            Assert.IsTrue(_scene.HasLogged("package://rogue/deadly.stl cannot be fetched: connection to"));
            Assert.AreEqual(4, connections, "the last for the other mesh");
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator WhatIsBeyondMaxTrianglesStaysASmallBox()
        {
            Connect();
            RobotDescriptionDisplay robot = Robot(
                made => made.MaxTriangles = 5, Mesh("package://rogue/3.stl"), Mesh("package://rogue/4.stl"),
                Mesh("package://rogue/2.stl"));
            yield return null;
            yield return _scene.Until(() => Shown(robot, 2).vertexCount == 6, "for the last mesh");
            Assert.AreEqual(9, Shown(robot, 0).vertexCount);
            Assert.AreEqual(BoxVertices, Shown(robot, 1).vertexCount);
            Assert.IsTrue(_scene.HasLogged(
                "4.stl cannot be drawn: with it, the robot's meshes have more than 5 triangles: a small box"));
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator WhileTheRobotIsHiddenSoAreThePartsThatCome()
        {
            Connect();
            RobotDescriptionDisplay robot = null;
            FixedFrame nowhere = _scene.Fixed("nowhere");
            robot = Robot(made => made.transform.SetParent(nowhere.transform, false), Mesh("package://rogue/65537.stl"));
            yield return _scene.Until(() => robot.IsHidden, "to be hidden");
            yield return _scene.Until(() => robot.transform.childCount == 2, "for both parts");
            Assert.IsTrue(robot.IsHidden);
            Assert.IsFalse(robot.transform.GetChild(0).GetComponent<MeshRenderer>().enabled);
            Assert.IsFalse(robot.transform.GetChild(1).GetComponent<MeshRenderer>().enabled);
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator OnlyAMeshOfAPackageIsFetchedAndOnlyIfItMay()
        {
            string[] others = { "package://rogue/1.obj", "http://rogue/1.stl", "model://rogue/1.stl", "package://rogue/1.stl.gz" };
            GatewayClient client = Connect();
            RobotDescriptionDisplay robot = Robot(Array.ConvertAll(others, uri => Mesh(uri)));
            yield return _scene.Until(() => client.IsConnected, "to be connected");
            yield return null;
            Assert.AreEqual(0, client.PendingRequests);
            foreach (string uri in others)
            {
                Assert.IsTrue(_scene.HasLogged("no model for " + uri
                    + " among Models, and the gateway serves only .stl and .dae by package:// or file://: a small box takes its place"), uri);
            }
            robot.FetchMeshes = false;
            Show(robot, Mesh("package://rogue/1.stl"));
            yield return null;
            yield return null;
            Assert.AreEqual(0, client.PendingRequests);
            Assert.IsTrue(_scene.HasLogged("no model for package://rogue/1.stl: a small box"));
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator AModelComesBeforeTheServedMesh()
        {
            GatewayClient client = Connect();
            GameObject model = _scene.Inactive("1");
            RobotDescriptionDisplay robot = Robot(made => made.Models = new[] { model }, Mesh("package://rogue/1.stl"));
            yield return _scene.Until(() => client.IsConnected, "to be connected");
            yield return null;
            yield return null;
            Assert.AreEqual(0, client.PendingRequests);
            Assert.AreEqual(1, robot.transform.childCount);
            Assert.IsNull(robot.transform.GetChild(0).GetComponent<MeshFilter>());
        }

        /// <summary>Waits within a frame.</summary>
        private static void Wait(Func<bool> holds, string what) =>
            Assert.IsTrue(SpinWait.SpinUntil(holds, 120000), "waited in vain " + what);

        private static string Mesh(string uri, string scale = "1 1 1") =>
            "<geometry><mesh filename='" + uri + "' scale='" + scale + "'/></geometry>";

        private static Mesh Shown(RobotDescriptionDisplay robot, int child) =>
            robot.transform.GetChild(child).GetComponent<MeshFilter>().sharedMesh;

        private static bool All(RobotDescriptionDisplay robot, Predicate<Mesh> holds)
        {
            for (int i = 0; i < robot.transform.childCount; i++)
            {
                if (!holds(Shown(robot, i)))
                {
                    return false;
                }
            }
            return true;
        }

        private static void Show(RobotDescriptionDisplay robot, params string[] visuals) =>
            robot.Show(new StringMsg
            {
                data = "<robot name='arm'><link name='base'>"
                    + string.Concat(Array.ConvertAll(visuals, visual => "<visual>" + visual + "</visual>")) + "</link></robot>",
            });

        private RobotDescriptionDisplay Robot(params string[] visuals) => Robot(null, visuals);

        private RobotDescriptionDisplay Robot(Action<RobotDescriptionDisplay> setUp, params string[] visuals)
        {
            RobotDescriptionDisplay robot = _scene.Display(setUp: setUp);
            Show(robot, visuals);
            return robot;
        }

        private GatewayClient Connect()
        {
            string address = Environment.GetEnvironmentVariable(Rogue);
            return _scene.Connect(made => made.Address = address + "/assets").Client;
        }
    }
}
