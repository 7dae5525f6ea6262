// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections;
using System.Collections.Generic;
using System.IO;
using System.Threading;
using NUnit.Framework;
using Ros2Gateway.Messages.NavMsgs;
using UnityEngine;
using UnityEngine.TestTools;
using Object = UnityEngine.Object;

namespace Ros2Gateway.Unity.Tests
{
    /// <summary>A connection and displays come and go in every order. A logged error fails a test.</summary>
    [TestFixture]
    public sealed class ConnectionTests
    {
        private const string OpenFiles = "/proc/self/fd"; // of Linux: sockets are among them
        private const string Threads = "/proc/self/task";

        private DisplayScene _scene;

        [SetUp]
        public void SetUp() => _scene = new DisplayScene();

        [TearDown]
        public void TearDown() => _scene.Dispose();

        [UnityTest]
        public IEnumerator WithoutAConnectionEverythingIsQuiet()
        {
            DigitalTwin twin = Twin();
            _scene.Display<LogScreen>();
            _scene.Display<ConnectionHud>();
            TopicPublisher publisher = _scene.Publisher("/chatter", "0", made =>
            {
                made.Rate = 100;
                made.Message = "{\"data\":\"x\"}";
            });
            yield return null;
            yield return null;
            Assert.IsNull(twin.Subscriber.Last);
            Assert.AreEqual(0, twin.Subscriber.Dropped);
            Assert.IsFalse(publisher.Publish(new OdometryMsg()));
            Assert.IsFalse(publisher.PublishJson("{}"));
            Assert.IsFalse(publisher.PublishTexture(Texture2D.whiteTexture));
            yield return _scene.Until(
                () => _scene.HasLogged("TopicSubscriber on DigitalTwin finds no Gateway Connection"), "for a warning");
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator MessagesComeWhicheverIsEnabledFirst([Values(false, true)] bool isDisplayFirst)
        {
            GatewayConnection connection = _scene.Connect();
            connection.enabled = !isDisplayFirst;
            DigitalTwin twin = Twin();
            yield return null;
            connection.enabled = true;
            yield return UntilFresh(twin);
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator ATokenOfCodeGoesBeforeThatOfTheSettings()
        {
            LogAssert.ignoreFailingMessages = true; // of refusals
            GatewayConnection connection = _scene.Connect(made =>
            {
                made.Address = Environment.GetEnvironmentVariable("ROS2GATEWAY_ROGUE_URL") + "/token";
                made.Client.Token = "of the client";
            });
            yield return UntilRefused(connection, "the token is of the client");
            connection.Settings.Token = "of the settings";
            yield return UntilRefused(connection, "the token is of the settings");
            connection.Token = "of code";
            Assert.AreEqual("of code", connection.Options().Token);
            yield return UntilRefused(connection, "the token is of code");
            connection.Token = null;
            connection.Settings.Token = "";
            yield return UntilRefused(connection, "the token is none");
            connection.Client.Token = "of the client again";
            yield return UntilRefused(connection, "the token is of the client again");
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator MessagesStopAndComeAgainWithTheConnection()
        {
            GatewayConnection connection = _scene.Connect();
            List<string> heard = new();
            connection.OnConnected.AddListener(() => heard.Add("up"));
            connection.OnDisconnected.AddListener(() => heard.Add("down"));
            DigitalTwin twin = Twin();
            for (int i = 0; i < 3; i++)
            {
                yield return UntilFresh(twin);
                connection.enabled = false;
                yield return null;
                IMessage last = twin.Subscriber.Last;
                yield return null;
                Assert.AreSame(last, twin.Subscriber.Last);
                Assert.IsFalse(connection.Client.IsConnected);
                connection.enabled = true;
            }
            yield return UntilFresh(twin);
            Assert.AreEqual("up down up down up down up", string.Join(" ", heard));
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator ASubscriberThatIsDisabledHearsNothingAndThenAgain()
        {
            _scene.Connect();
            DigitalTwin twin = Twin();
            yield return UntilFresh(twin);
            DigitalTwin witness = Twin();
            twin.Subscriber.enabled = false;
            IMessage last = twin.Subscriber.Last;
            yield return UntilFresh(witness);
            yield return UntilFresh(witness);
            Assert.AreSame(last, twin.Subscriber.Last);
            twin.Subscriber.enabled = true;
            yield return UntilFresh(twin);
            twin.gameObject.SetActive(false);
            yield return null;
            twin.gameObject.SetActive(true);
            yield return UntilFresh(twin);
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator WhateverIsDestroyedFirstNothingFails([Values(0, 1, 2)] int first)
        {
            GatewayConnection connection = _scene.Connect();
            DigitalTwin twin = Twin();
            LogScreen log = _scene.Display<LogScreen>();
            _scene.Display<ConnectionHud>();
            TopicPublisher publisher = _scene.Publisher("/chatter", "std_msgs/msg/String", made =>
            {
                made.Rate = 100;
                made.Message = "{\"data\":\"x\"}";
            });
            yield return UntilFresh(twin);
            Object[] order = { connection.gameObject, twin.gameObject, publisher.gameObject, log.gameObject };
            for (int i = 0; i < order.Length; i++)
            {
                Object.DestroyImmediate(order[(i + first) % order.Length]);
                yield return null;
                yield return null;
            }
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator HandlersAreCalledOnTheMainThread()
        {
            int here = Thread.CurrentThread.ManagedThreadId;
            List<int> threads = new();
            Action note = () => threads.Add(Thread.CurrentThread.ManagedThreadId);
            GatewayConnection connection = _scene.Connect();
            connection.EventHeard += happened => note();
            connection.StateChanged += state => note();
            DigitalTwin twin = Twin();
            twin.Subscriber.OnMessage.AddListener(message =>
            {
                twin.name = "touched"; // which Unity refuses on any other thread
                note();
            });
            yield return UntilFresh(twin);
            connection.Client.Request("hello", null, reply => note());
            yield return _scene.Until(() => threads.Count > 10, "for handlers to be called");
            Assert.IsTrue(threads.TrueForAll(thread => thread == here));
            Assert.AreEqual("touched", twin.name);
        }

        [Test]
        public void ADisplayIsOfTheMainThreadAlone()
        {
            DigitalTwin twin = Twin();
            Exception refusal = null;
            Thread other = new(() =>
            {
                try
                {
                    twin.Show(new OdometryMsg());
                }
                catch (UnityException error)
                {
                    refusal = error;
                }
            });
            other.Start();
            other.Join();
            Assert.IsNotNull(refusal);
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator ScenesThatEndLeaveNoThreadAndNoSocket()
        {
            if (!Directory.Exists(OpenFiles))
            {
                Assert.Ignore("counts open files and threads as Linux tells them");
            }
            for (int i = 0; i < 3; i++) // the pool has its threads then
            {
                yield return PlayOnce();
            }
            int files = Count(OpenFiles);
            int threads = Count(Threads);
            for (int i = 0; i < 10; i++)
            {
                yield return PlayOnce();
            }
            yield return _scene.Until(() => Count(OpenFiles) <= files, "for sockets to be closed");
            // one of ten that were left would be seen. Two are the pool's own coming and going
            yield return _scene.Until(() => Count(Threads) <= threads + 2, "for threads to end");
        }

        private IEnumerator PlayOnce()
        {
            using DisplayScene scene = new();
            scene.Connect();
            DigitalTwin twin = scene.Display<DigitalTwin>("/odom", OdometryMsg.Type);
            yield return scene.Until(() => twin.Subscriber.Last != null, "for odometry");
        }

        private DigitalTwin Twin() => _scene.Display<DigitalTwin>("/odom", OdometryMsg.Type);

        /// <summary>Frames until a message has come that was not there before.</summary>
        private IEnumerator UntilRefused(GatewayConnection connection, string reason)
        {
            connection.enabled = false;
            _scene.Logged.Clear();
            connection.enabled = true;
            return _scene.Until(() => _scene.HasLogged(reason + " ("), reason);
        }

        private IEnumerator UntilFresh(DigitalTwin twin)
        {
            IMessage last = twin.Subscriber.Last;
            return _scene.Until(() => !ReferenceEquals(twin.Subscriber.Last, last), "for odometry");
        }

        private static int Count(string folder) => Directory.GetFileSystemEntries(folder).Length;
    }
}
