// SPDX-License-Identifier: Apache-2.0
using System.Collections;
using System.Reflection;
using System.Text.RegularExpressions;
using NUnit.Framework;
using Ros2Gateway.Messages;
using Ros2Gateway.Messages.BuiltinInterfaces;
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Messages.NavMsgs;
using Ros2Gateway.Messages.SensorMsgs;
using Ros2Gateway.Messages.StdMsgs;
using UnityEngine;
using UnityEngine.TestTools;

namespace Ros2Gateway.Unity.Tests
{
    /// <summary>Topic Subscriber and Topic Publisher through a live gateway.</summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class TopicComponentTests
    {
        private DisplayScene _scene;

        [SetUp]
        public void SetUp()
        {
            MessageCatalogue.Register<OdometryMsg>();
            MessageCatalogue.Register<StringMsg>();
            MessageCatalogue.Register<PathMsg>();
            _scene = new DisplayScene();
            _scene.Connect();
        }

        [TearDown]
        public void TearDown() => _scene.Dispose();

        [UnityTest]
        public IEnumerator ATypeMayBeANumberOfTheTable()
        {
            TopicSubscriber subscriber = Subscriber("/odom", "9");
            yield return _scene.Until(() => subscriber.Last != null, "for odometry");
            Assert.IsInstanceOf<OdometryMsg>(subscriber.Last);
            yield return _scene.Until(() => subscriber.RateHz > 1, "for the rate");
            Assert.Greater(subscriber.LastTime, 0);
        }

        [UnityTest]
        public IEnumerator WithoutATypeMessagesAreTrees()
        {
            TopicSubscriber subscriber = Subscriber("/odom", "");
            yield return _scene.Until(() => subscriber.Last != null, "for odometry");
            DynamicMessage message = (DynamicMessage)subscriber.Last;
            Assert.AreEqual("odom", message.Value["header"]["frame_id"].AsString());
        }

        [UnityTest]
        public IEnumerator AnUnknownTypeIsAnEventInWords()
        {
            LogAssert.ignoreFailingMessages = true;
            TopicSubscriber subscriber = Subscriber("/anything", "no_such/msg/Thing");
            yield return _scene.Until(() => _scene.HasLogged("no_such"), "for words");
            Assert.IsNull(subscriber.Last);
        }

        [UnityTest]
        public IEnumerator AnImageComesAsJpegAndIsShown()
        {
            ImageScreen screen = _scene.Display<ImageScreen>(
                "/camera/image_raw", "sensor_msgs/msg/Image", DisplayParts.OnRenderer);
            yield return _scene.Until(() => screen.Texture != null, "for a picture");
            Assert.IsInstanceOf<CompressedImageMsg>(screen.Subscriber.Last);
            Assert.Greater(screen.Texture.width, 0);
        }

        [UnityTest]
        public IEnumerator AnImageHasTheSizeThatTheInspectorAsksFor()
        {
            ImageScreen screen = _scene.Display<ImageScreen>("/camera/image_raw", "5", made =>
            {
                DisplayParts.OnRenderer(made);
                InInspector(made.GetComponent<TopicSubscriber>(), "_imageMaxWidth", 100);
            });
            yield return _scene.Until(() => screen.Texture != null, "for a picture");
            Assert.AreEqual(100, screen.Texture.width);
        }

        [UnityTest]
        public IEnumerator OnlyTheFieldsThatTheInspectorNamesCome()
        {
            TopicSubscriber subscriber = _scene.Display<TopicSubscriber>("/odom", OdometryMsg.Type, made =>
            {
                InInspector(made, "_fields", new[] { "child_frame_id" });
            });
            yield return _scene.Until(() => subscriber.Last != null, "for odometry");
            OdometryMsg odometry = (OdometryMsg)subscriber.Last;
            Assert.AreEqual("base_footprint", odometry.child_frame_id);
            Assert.AreEqual("", odometry.header.frame_id);
        }

        [UnityTest]
        public IEnumerator ADisplayOfAnotherTypeSaysSo()
        {
            DigitalTwin twin = _scene.Display<DigitalTwin>("/odom", "");
            yield return _scene.Until(
                () => _scene.HasLogged("shows OdometryMsg, but /odom carries"), "for words");
            Assert.AreEqual(Vector3.zero, twin.transform.localPosition);
        }

        [UnityTest]
        public IEnumerator AMessageOfTheInspectorIsPublishedAtItsRate()
        {
            TopicSubscriber subscriber = Subscriber("/inspector", StringMsg.Type);
            _scene.Publisher("/inspector", "0", made =>
            {
                made.Rate = 50;
                made.Message = "{\"data\":\"hello\"}";
            });
            yield return _scene.Until(() => subscriber.Last != null, "for the message");
            Assert.AreEqual("hello", ((StringMsg)subscriber.Last).data);
        }

        [UnityTest]
        public IEnumerator FieldsOfTheInspectorArePublishedWithTheTimeOfNow()
        {
            TopicSubscriber subscriber = Subscriber("/fields", PathMsg.Type);
            PathMsg path = new();
            path.header.frame_id = "map";
            path.header.stamp = new TimeMsg(); // as Unity has it after it has loaded the scene
            PoseStampedMsg stamped = new();
            stamped.header.stamp = new TimeMsg { sec = 7 };
            path.poses = new[] { stamped };
            _scene.Publisher("/fields", PathMsg.Type, made =>
            {
                made.Rate = 50;
                made.Message = "{\"none\":\"of this\"}";
                made.Fields = path;
            });
            yield return _scene.Until(() => subscriber.Last != null, "for the message");
            PathMsg heard = (PathMsg)subscriber.Last;
            Assert.AreEqual("map", heard.header.frame_id);
            Assert.Greater(heard.header.stamp.sec, 1000000);
            Assert.AreEqual(7, heard.poses[0].header.stamp.sec);
        }

        [UnityTest]
        public IEnumerator AMessageThatIsNoJsonIsAnErrorOnceAndAnotherOneIsPublished()
        {
            LogAssert.Expect(LogType.Error, new Regex("Topic Publisher of /inspector2: "));
            TopicSubscriber subscriber = Subscriber("/inspector2", StringMsg.Type);
            TopicPublisher publisher = _scene.Publisher("/inspector2", StringMsg.Type, made =>
            {
                made.Rate = 100;
                made.Message = "{data: hello}";
            });
            yield return _scene.Until(() => _scene.Logged.Exists(IsRefusal), "for the error");
            yield return _scene.Until(() => _scene.Connection.Client.RosClock.IsKnown, "for time to pass");
            publisher.Message = "{\"data\":\"right\"}";
            yield return _scene.Until(() => subscriber.Last != null, "for the message");
            Assert.AreEqual(1, _scene.Logged.FindAll(IsRefusal).Count);
        }

        [UnityTest]
        public IEnumerator JsonFromCodeIsPublishedOrRefusedInWords()
        {
            LogAssert.ignoreFailingMessages = true;
            TopicSubscriber subscriber = Subscriber("/from_code", StringMsg.Type);
            TopicPublisher publisher = _scene.Publisher("/from_code", StringMsg.Type);
            Assert.IsFalse(publisher.PublishJson(null));
            Assert.IsFalse(publisher.PublishJson("{\"data\":"));
            yield return _scene.Until(
                () => subscriber.Last != null,
                "for the message",
                () => publisher.PublishJson("{\"data\":\"x\"}"));
            publisher.PublishJson("{\"data\":5}");
            yield return _scene.Until(() => _scene.HasLogged("data: expected a string, got 5"), "for words");
        }

        [UnityTest]
        public IEnumerator ATextureIsPublishedInItsSizeWithTheTimeOfRos()
        {
            TopicSubscriber subscriber = Subscriber("/texture", CompressedImageMsg.Type);
            ImageScreen screen = _scene.Display<ImageScreen>(
                "/texture", CompressedImageMsg.Type, DisplayParts.OnRenderer);
            Texture2D texture = new(1280, 720);
            GameObject holder = _scene.Inactive("texture publisher");
            TexturePublisher source = holder.AddComponent<TexturePublisher>();
            source.Source = texture;
            source.FrameId = "head";
            TopicPublisher publisher = holder.GetComponent<TopicPublisher>();
            publisher.Topic = "/texture";
            publisher.Type = CompressedImageMsg.Type;
            publisher.Rate = 30;
            publisher.ImageMaxWidth = 320;
            publisher.ImageMaxHeight = 100;
            yield return _scene.Until(() => _scene.Connection.Client.RosClock.IsKnown, "for the clock");
            holder.SetActive(true);
            yield return _scene.Until(() => screen.Texture != null, "for the picture");
            Assert.AreEqual(178, screen.Texture.width); // 100 / 720 of 1280
            Assert.AreEqual(100, screen.Texture.height);
            CompressedImageMsg picture = (CompressedImageMsg)subscriber.Last;
            Assert.AreEqual("head", picture.header.frame_id);
            Assert.AreEqual(_scene.Connection.Client.RosClock.RosSeconds, picture.header.stamp.sec, 60);
            Object.DestroyImmediate(texture);
            yield return null;
            yield return null;
        }

        [UnityTest]
        public IEnumerator WhatACameraSeesIsPublishedAndTheCameraGivenBack()
        {
            ImageScreen screen = _scene.Display<ImageScreen>(
                "/seen", CompressedImageMsg.Type, DisplayParts.OnRenderer);
            GameObject holder = _scene.Inactive("camera publisher");
            TexturePublisher source = holder.AddComponent<TexturePublisher>();
            source.Camera = holder.AddComponent<Camera>();
            TopicPublisher publisher = holder.GetComponent<TopicPublisher>();
            publisher.Topic = "/seen";
            publisher.Type = "8";
            publisher.Rate = 30;
            holder.SetActive(true);
            RenderTexture target = source.Camera.targetTexture;
            Assert.AreEqual(480, target.height);
            yield return _scene.Until(() => screen.Texture != null, "for the picture");
            Assert.AreEqual(640, screen.Texture.width);
            Assert.AreEqual(480, screen.Texture.height);
            holder.SetActive(false);
            Assert.IsNull(source.Camera.targetTexture);
            yield return null;
            yield return null;
            Assert.IsTrue(target == null);
        }

        [UnityTest]
        public IEnumerator APictureThatIsUnderWayWhenItsPublisherIsDisabledIsForgottenWithoutAWord()
        {
            TopicPublisher publisher = _scene.Publisher("/forgotten", CompressedImageMsg.Type, made => { });
            Texture2D texture = new(4, 4);
            yield return _scene.Until(() => publisher.PublishTexture(texture), "to begin");
            publisher.gameObject.SetActive(false);
            publisher.gameObject.SetActive(true);
            yield return _scene.Until(() => publisher.PublishTexture(texture), "for the end of the first one");
            yield return _scene.Until(() => publisher.PublishTexture(texture), "for the end of the second one");
            Assert.IsEmpty(_scene.Logged.FindAll(text => text.Contains("disposed")));
            Object.DestroyImmediate(texture);
        }

        /// <summary>Sets what only the Inspector can set.</summary>
        private static void InInspector(TopicSubscriber subscriber, string field, object value)
        {
            const BindingFlags Private = BindingFlags.Instance | BindingFlags.NonPublic;
            typeof(TopicSubscriber).GetField(field, Private).SetValue(subscriber, value);
        }

        private static bool IsRefusal(string text) => text.Contains("Topic Publisher of /inspector2: ");

        private TopicSubscriber Subscriber(string topic, string type) => _scene.Display<TopicSubscriber>(topic, type);
    }
}
