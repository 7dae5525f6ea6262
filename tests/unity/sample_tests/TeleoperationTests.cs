// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections;
using NUnit.Framework;
using Ros2Gateway.Drive;
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Samples.Teleoperation;
using Ros2Gateway.Unity;
using UnityEngine;
using UnityEngine.TestTools;

namespace Ros2Gateway.Samples.Tests
{
    [TestFixture]
    public sealed class TeleoperationTests
    {
        private sealed class Keys : IDriveInput
        {
            public DriveKeys Held { get; set; }

            public bool StopPressed { get; set; }
        }

        private sealed class Walk : IWalkInput
        {
            public Vector2 Move { get; set; }

            public Vector2 Look { get; set; }

            public bool GrabPressed { get; set; }

            public bool ReleasePressed { get; set; }
        }

        private DemoScene _demo;

        [TearDown]
        public void TearDown()
        {
            if (_demo != null)
            {
                _demo.Dispose();
                _demo = null;
            }
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator The_robot_is_driven_and_its_twin_follows()
        {
            _demo = new DemoScene();
            _demo.Add<TeleoperationScene>().Address = DemoScene.Address;
            _demo.Begin();
            Keys keys = new Keys();
            GameObject.Find("Teleop Driver").GetComponent<TeleopDriver>().Input = keys;
            Transform twin = GameObject.Find("Digital Twin").transform;
            GatewayClient client = _demo.Root.GetComponentInChildren<GatewayConnection>().Client;
            TwistMsg heard = new TwistMsg();
            client.Subscribe<TwistMsg>("/cmd_vel", twist => heard = twist);
            yield return _demo.Until(() => client.IsConnected, "to be connected");
            yield return _demo.Reset(client, twin);
            keys.Held = DriveKeys.Forward;
            yield return _demo.Until(() => twin.position.z > 0.1f, "for the twin to be ahead");
            Assert.AreEqual(0.26, heard.linear.x, 1e-6);
            TextMesh state = GameObject.Find("Drive's State").GetComponent<TextMesh>();
            yield return _demo.Until(() => state.text == "you drive", "to be told who drives");
            keys.StopPressed = true;
            yield return null;
            keys.StopPressed = false;
            yield return _demo.Until(() => heard.linear.x == 0, "for zero");
            Assert.AreEqual(0, twin.position.x, 0.05);
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator All_screens_show_the_simulated_robots_topics()
        {
            _demo = new DemoScene();
            _demo.Add<TeleoperationScene>().Address = DemoScene.Address;
            _demo.Begin();
            TopicSubscriber[] subscribers = _demo.Root.GetComponentsInChildren<TopicSubscriber>();
            Assert.AreEqual(5, subscribers.Length);
            yield return _demo.Until(
                () => Array.TrueForAll(subscribers, one => one.Last != null), "for messages on all screens");
        }

        [UnityTest]
        public IEnumerator The_player_walks_where_it_looks()
        {
            GameObject player = new GameObject("player");
            GameObject eyes = new GameObject("eyes");
            eyes.transform.SetParent(player.transform, false);
            Walk walk = new Walk { Move = new Vector2(0, 1) };
            PlayerWalk control = player.AddComponent<PlayerWalk>();
            control.Eyes = eyes.transform;
            control.Input = walk;
            while (player.transform.position.z < 0.1f)
            {
                yield return null;
            }
            Assert.AreEqual(0, player.transform.position.x, 1e-4);
            walk.Move = Vector2.zero;
            walk.Look = new Vector2(900, 5000); // 90 degrees to the right, and further up than a neck goes
            yield return null;
            Assert.AreEqual(0, player.transform.eulerAngles.y, 1e-3, "nobody has grabbed the mouse");
            walk.GrabPressed = true;
            yield return null;
            walk.GrabPressed = false;
            walk.Look = Vector2.zero;
            Assert.AreEqual(90, player.transform.eulerAngles.y, 1e-2);
            Assert.AreEqual(275, eyes.transform.localEulerAngles.x, 1e-2);
            walk.Move = new Vector2(0, 1);
            while (player.transform.position.x < 0.1f)
            {
                yield return null;
            }
            walk.ReleasePressed = true;
            yield return null;
            Assert.AreEqual(CursorLockMode.None, Cursor.lockState);
            UnityEngine.Object.DestroyImmediate(player);
        }
    }
}
