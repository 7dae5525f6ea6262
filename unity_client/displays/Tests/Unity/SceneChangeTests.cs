// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections;
using System.Collections.Generic;
using NUnit.Framework;
using Ros2Gateway.Messages;
using Ros2Gateway.Messages.NavMsgs;
using Ros2Gateway.Messages.StdMsgs;
using UnityEngine.SceneManagement;
using UnityEngine.TestTools;
using Object = UnityEngine.Object;

namespace Ros2Gateway.Unity.Tests
{
    /// <summary>Connections come late, go early, and change with scenes. Components take what there is.</summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class SceneChangeTests
    {
        private DisplayScene _scene;
        private Scene _first;

        [SetUp]
        public void SetUp()
        {
            _scene = new DisplayScene();
            _first = SceneManager.GetActiveScene();
        }

        [TearDown]
        public void TearDown()
        {
            SceneManager.SetActiveScene(_first);
            _scene.Dispose();
        }

        [UnityTest]
        public IEnumerator AConnectionMayComeAfterAllThatNeedIt()
        {
            DigitalTwin twin = Twin();
            TopicPublisher publisher = _scene.Publisher("/late", StringMsg.Type);
            LogScreen log = _scene.Display<LogScreen>();
            yield return null;
            yield return null;
            GatewayConnection connection = _scene.Connect();
            yield return UntilFresh(twin);
            yield return _scene.Until(() => publisher.Publish(new StringMsg()), "to publish");
            Assert.AreSame(connection, publisher.Connection);
            Assert.AreSame(connection, log.Connection);
            Assert.IsFalse(_scene.HasLogged("finds no Gateway Connection"));
        }

        [UnityTest]
        public IEnumerator AConnectionThatIsMadeAnewIsTakenByAllThatOutliveTheFormer([Values(false, true)] bool isChosen)
        {
            GatewayConnection former = _scene.Connect();
            DigitalTwin twin = Twin();
            twin.Subscriber.Connection = isChosen ? former : null;
            TopicPublisher publisher = _scene.Publisher("/anew", StringMsg.Type);
            TeleopDriver driver = _scene.Display<TeleopDriver>();
            yield return UntilFresh(twin);
            Object.DestroyImmediate(former.gameObject);
            yield return null;
            Assert.IsFalse(publisher.Publish(new StringMsg()));
            Assert.IsNull(driver.Control);
            Assert.AreEqual("no Gateway Connection", driver.Status);
            GatewayConnection next = _scene.Connect();
            yield return UntilFresh(twin);
            yield return _scene.Until(() => publisher.Publish(new StringMsg()), "to publish");
            Assert.AreSame(next, twin.Subscriber.Connection);
            Assert.AreSame(next, driver.Connection);
            Assert.IsNotNull(driver.Control);
        }

        [UnityTest]
        public IEnumerator ANewConnectionMayBeThereBeforeTheFormerGoes([Values("destroyed", "disabled")] string how)
        {
            GatewayConnection former = _scene.Connect();
            DigitalTwin twin = Twin();
            yield return UntilFresh(twin);
            GatewayConnection next = _scene.Connect();
            yield return null;
            Assert.AreSame(former, twin.Subscriber.Connection, "it had no reason to change");
            if (how == "destroyed")
            {
                Object.DestroyImmediate(former.gameObject);
            }
            else
            {
                former.enabled = false;
            }
            Assert.AreSame(next, twin.Subscriber.Connection);
            yield return UntilFresh(twin);
        }

        [UnityTest]
        public IEnumerator WhatMovesRobotsAndWhatWasChosenTakeNoConnectionToAnotherAddress(
            [Values("destroyed", "disabled")] string how)
        {
            LogAssert.ignoreFailingMessages = true; // nobody answers at the other address
            GatewayConnection former = _scene.Connect();
            TeleopDriver driver = _scene.Display<TeleopDriver>();
            NavigateToPose navigation = _scene.Display<NavigateToPose>();
            TopicPublisher publisher = _scene.Publisher("/elsewhere", StringMsg.Type);
            LogScreen chosen = _scene.Display<LogScreen>("", "", made => made.Connection = former);
            LogScreen free = _scene.Display<LogScreen>();
            ConnectedBehaviour[] faithful = { driver, navigation, publisher, chosen };
            GatewayConnection elsewhere = _scene.Connect(made => made.Address = "ws://127.0.0.1:9");
            if (how == "disabled")
            {
                former.enabled = false;
                Assert.IsTrue(Array.TrueForAll(faithful, one => one.Connection == former));
                Assert.AreSame(former, free.Connection, "it may be enabled again");
                former.enabled = true;
            }
            else
            {
                Object.DestroyImmediate(former.gameObject);
                Assert.IsTrue(Array.TrueForAll(faithful, one => one.Connection == null));
                Assert.AreSame(elsewhere, free.Connection);
                driver.enabled = false;
                driver.enabled = true;
                Assert.IsTrue(driver.Connection == null);
                yield return _scene.Until(
                    () => _scene.HasLogged("any more: add it, or set Connection"), "for a warning");
                former = _scene.Connect();
            }
            Assert.IsTrue(Array.TrueForAll(faithful, one => one.Connection == former));
            yield return _scene.Until(() => driver.CommandType != null, "to be able to drive");
            driver.Connection = elsewhere;
            Assert.AreSame(elsewhere, driver.Connection, "it was chosen");
        }

        [UnityTest]
        public IEnumerator OverAdditiveScenesTheOwnSceneComesFirstThenAnyOther()
        {
            Scene other = SceneManager.CreateScene("other " + Guid.NewGuid());
            GatewayConnection here = _scene.Connect();
            SceneManager.SetActiveScene(other);
            GatewayConnection there = _scene.Connect();
            DigitalTwin twinThere = Twin();
            SceneManager.SetActiveScene(_first);
            DigitalTwin twinHere = Twin();
            Assert.AreSame(there, twinThere.Subscriber.Connection);
            Assert.AreSame(here, twinHere.Subscriber.Connection);
            Object.DestroyImmediate(here.gameObject);
            Assert.AreSame(there, twinHere.Subscriber.Connection);
            yield return UntilFresh(twinHere);
            yield return SceneManager.UnloadSceneAsync(other);
            yield return _scene.Until(() => there == null, "for the scene to be gone");
            Assert.IsTrue(twinHere.Subscriber.Connection == null);
            _scene.Connect();
            yield return UntilFresh(twinHere);
        }

        [UnityTest]
        public IEnumerator AConnectionThatIsNotDestroyedOnLoadServesTheNextSceneAndIsThereOnce()
        {
            Scene level = SceneManager.CreateScene("level " + Guid.NewGuid());
            SceneManager.SetActiveScene(level);
            GatewayConnection lasting = _scene.Connect(made => made.OutlivesScenes = true);
            DigitalTwin gone = Twin();
            yield return UntilFresh(gone);
            SceneManager.SetActiveScene(_first);
            yield return SceneManager.UnloadSceneAsync(level);
            yield return _scene.Until(() => gone == null, "for the scene to be gone");
            Assert.IsTrue(lasting.Client.IsConnected);

            // The scene is loaded again, with its own connection that components in it have chosen.
            GatewayConnection second = _scene.Connect(made => made.OutlivesScenes = true);
            DigitalTwin twin = Twin();
            twin.Subscriber.Connection = second;
            Assert.AreSame(lasting, twin.Subscriber.Connection);
            yield return UntilFresh(twin);
            Assert.IsTrue(second == null);
            Assert.IsTrue(lasting.Client.IsConnected);
        }

        [UnityTest]
        public IEnumerator AnotherConnectionIsUsedAsSoonAsItIsChosen()
        {
            _scene.Connect();
            GatewayConnection other = _scene.Connect();
            DigitalTwin twin = Twin();
            yield return UntilFresh(twin);
            twin.Subscriber.Connection = other;
            Assert.AreSame(other, twin.Subscriber.Connection);
            Object.DestroyImmediate(other.gameObject);
            yield return UntilFresh(twin);
        }

        [UnityTest]
        public IEnumerator WhileTheApplicationIsPausedThereIsNoConnectionAndThenThereIs()
        {
            GatewayConnection connection = _scene.Connect();
            int farewells = 0;
            connection.Leaving += leaving => farewells++;
            connection.SendMessage("OnApplicationPause", false); // as Android does at the start
            DigitalTwin twin = Twin();
            yield return UntilFresh(twin);
            Assert.AreEqual(0, farewells);
            connection.SendMessage("OnApplicationPause", true);
            Assert.AreEqual(ConnectionState.Disconnected, connection.Client.State);
            Assert.AreEqual(1, farewells);
            connection.SendMessage("OnApplicationPause", false);
            Assert.AreNotEqual(ConnectionState.Disconnected, connection.Client.State);
            yield return UntilFresh(twin);
        }

        [UnityTest]
        public IEnumerator AListenerThatThrowsHarmsNoOtherAndIsToldOnceWithACount()
        {
            LogAssert.ignoreFailingMessages = true; // that it is told is the point
            int messages = 0;
            int states = 0;
            GatewayConnection connection = _scene.Connect();
            connection.StateChanged += state => Throw("by state");
            connection.StateChanged += state => states++;
            connection.OnConnected.AddListener(() => Throw("by inspector"));
            DigitalTwin twin = Twin();
            TopicSubscriber subscriber = _scene.Display<TopicSubscriber>("/odom", OdometryMsg.Type);
            subscriber.MessageReceived += message => Throw("by code");
            subscriber.MessageReceived += message => messages++;
            subscriber.OnMessage.AddListener(message => Throw("by list"));
            yield return _scene.Until(() => messages >= 12 && states > 0, "for messages");
            yield return UntilFresh(twin);
            yield return _scene.Until(
                () => Told("listener of MessageReceived of TopicSubscriber on TopicSubscriber threw InvalidOperationException, 10 times by now: by code") == 1,
                "for the count");
            Assert.AreEqual(1, Told("listener of MessageReceived of TopicSubscriber on TopicSubscriber threw InvalidOperationException: by code"));
            Assert.AreEqual(1, Told("listener of On Message of TopicSubscriber on TopicSubscriber threw InvalidOperationException: by list"));
            Assert.AreEqual(1, Told("listener of StateChanged threw InvalidOperationException: by state"));
            Assert.AreEqual(1, Told("listener of On Connected or On Disconnected threw InvalidOperationException: by inspector"));
        }

        [UnityTest]
        public IEnumerator DisplaysAskForTheNewestAloneAndOthersForEveryMessage()
        {
            GatewayConnection connection = _scene.Connect();
            TextScreen screen = _scene.Display<TextScreen>("/texts", StringMsg.Type);
            TopicSubscriber subscriber = _scene.Display<TopicSubscriber>("/texts", StringMsg.Type);
            List<string> heard = new();
            MessageCatalogue.Register<StringMsg>();
            subscriber.MessageReceived += message => heard.Add(((StringMsg)message).data);
            TopicPublisher publisher = _scene.Publisher("/texts", StringMsg.Type);
            yield return _scene.Until(() => connection.Client.IsConnected, "to be connected");
            yield return _scene.Until(
                () => screen.Subscriber.Last != null && heard.Count > 0, "for texts", () => publisher.PublishJson("{}"));
            long dropped = screen.Subscriber.Dropped;
            heard.Clear();
            for (int i = 0; i < 20; i++)
            {
                Assert.IsTrue(publisher.Publish(new StringMsg { data = i.ToString() }));
            }
            // All of them come while no frame goes by.
            Assert.IsTrue(System.Threading.SpinWait.SpinUntil(
                () => screen.Subscriber.Dropped - dropped >= 19, 120000), "the display let more than one wait");
            yield return _scene.Until(() => heard.Contains("19"), "for the last");
            heard.RemoveAll(string.IsNullOrEmpty); // of those before, which were still on their way
            Assert.AreEqual("0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19", string.Join(" ", heard));
        }

        private static void Throw(string words) => throw new InvalidOperationException(words);

        private int Told(string words) => _scene.Logged.FindAll(text => text.Contains(words)).Count;

        private DigitalTwin Twin() => _scene.Display<DigitalTwin>("/odom", OdometryMsg.Type);

        /// <summary>Frames until a message has come that was not there before.</summary>
        private IEnumerator UntilFresh(DigitalTwin twin)
        {
            IMessage last = twin.Subscriber.Last;
            return _scene.Until(() => !ReferenceEquals(twin.Subscriber.Last, last), "for odometry");
        }
    }
}
