// SPDX-License-Identifier: Apache-2.0
using System.Collections;
using NUnit.Framework;
using UnityEngine;
using UnityEngine.TestTools;

namespace Ros2Gateway.Unity.Tests
{
    [TestFixture]
    public sealed class ConnectionHudTests
    {
        private DisplayScene _scene;
        private ConnectionHud _hud;
        private TextMesh _text;

        [SetUp]
        public void SetUp()
        {
            _scene = new DisplayScene();
            _hud = _scene.Display<ConnectionHud>(
                setUp: made => _text = made.gameObject.AddComponent<TextMesh>());
        }

        [TearDown]
        public void TearDown() => _scene.Dispose();

        [UnityTest]
        public IEnumerator WithoutAConnectionItSaysSo()
        {
            yield return _scene.Until(() => _text.text == "no Gateway Connection in the scene", "for words");
            Assert.AreEqual(Color.gray, _text.color);
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator ItFollowsTheConnection()
        {
            GatewayConnection connection = _scene.Connect();
            TopicSubscriber subscriber = _scene.Display<TopicSubscriber>(
                setUp: made =>
                {
                    made.Topic = "/odom";
                    made.Connection = connection;
                });
            yield return _scene.Until(
                () => _hud.MessagesPerSecond > 1 && _hud.KilobytesPerSecond > 0.1, "for messages");
            yield return _scene.Until(() => !_text.text.Contains("round trip 0.0 "), "for a round trip");
            StringAssert.StartsWith("connected " + connection.Settings.Address + "\nround trip ", _text.text);
            StringAssert.Contains(" messages/s, ", _text.text);
            StringAssert.Contains("\ndropped ", _text.text);
            StringAssert.EndsWith("pending requests 0", _text.text);
            Assert.AreEqual(Color.green, _text.color);
            Assert.IsNotNull(subscriber.Last);
            connection.enabled = false;
            yield return _scene.Until(() => _text.text.StartsWith("disconnected"), "to see the end");
            Assert.AreEqual(Color.gray, _text.color);
            Object.DestroyImmediate(connection.gameObject);
            yield return _scene.Until(() => _text.text.StartsWith("no Gateway"), "to see that it is gone");
        }
    }
}
