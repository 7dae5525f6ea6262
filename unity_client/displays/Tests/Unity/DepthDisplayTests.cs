// SPDX-License-Identifier: Apache-2.0
using System.Collections;
using System.Text.RegularExpressions;
using NUnit.Framework;
using Ros2Gateway.Messages.SensorMsgs;
using UnityEngine;
using UnityEngine.TestTools;

namespace Ros2Gateway.Unity.Tests
{
    [TestFixture]
    [Category("Inflates")]
    public sealed class DepthDisplayTests
    {
        private DisplayScene _scene;

        [SetUp]
        public void SetUp() => _scene = new DisplayScene();

        [TearDown]
        public void TearDown() => _scene.Dispose();

        [UnityTest]
        public IEnumerator WhatIsNoDepthIsSaidWithTheRemedy()
        {
            LogAssert.Expect(LogType.Warning, new Regex("set the subscriber's Image Format to png"));
            LogAssert.Expect(LogType.Warning, new Regex("sensor_msgs/msg/CameraInfo"));
            LogAssert.Expect(LogType.Warning, new Regex("not calibrated"));
            DepthDisplay display = _scene.Display<DepthDisplay>();
            display.Show(new CompressedImageMsg { format = "jpeg", data = new byte[] { 0xff, 0xd8, 0xff } });
            display.SetCamera(new CompressedImageMsg());
            display.SetCamera(new CameraInfoMsg());
            yield return null;
            Assert.AreEqual(0, display.Drawn);
            Assert.IsTrue(float.IsInfinity(display.AgeSeconds));
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator PicturesThatAreFilledAnewAreDrawn()
        {
            GatewayClient client = _scene.Connect().Client;
            DepthDisplay display = _scene.Display<DepthDisplay>("/depth/filled_anew", ImageMsg.Type, made =>
            {
                made.GetComponent<TopicSubscriber>().ImageFormat = "png";
                made.GetComponent<TopicSubscriber>().Reuse = true;
            });
            Publisher<ImageMsg> camera = client.Advertise<ImageMsg>("/depth/filled_anew");
            ImageMsg picture = new() { encoding = "16UC1", width = 2, height = 1, step = 4 };
            picture.data = new byte[] { 1, 2, 3, 4 };
            yield return _scene.Until(() => client.IsConnected, "to be connected");
            yield return _scene.Until(
                () => display.Subscriber.Last != null, "for a picture", () => camera.Publish(picture, evenLate: true));
            yield return null;
            Assert.AreEqual(2, display.Drawn);
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator ACamerasDepthIsPointsAheadOfIt()
        {
            _scene.Connect();
            DepthDisplay display = _scene.Display<DepthDisplay>(
                "/depth/image_raw", ImageMsg.Type, made => made.GetComponent<TopicSubscriber>().ImageFormat = "png");
            GatewayClient client = _scene.Connection.Client;
            Publisher<ImageMsg> camera = client.Advertise<ImageMsg>("/depth/image_raw");
            ImageMsg picture = new() { encoding = "16UC1", width = 20, height = 10, step = 40, data = new byte[400] };
            picture.header.frame_id = "depth_optical";
            for (int i = 0; i < 100; i++) // the upper half is 1.5 m away, of the lower nothing is known
            {
                picture.data[2 * i] = 1500 & 255;
                picture.data[2 * i + 1] = 1500 >> 8;
            }
            yield return _scene.Until(() => client.IsConnected, "to be connected");
            yield return _scene.Until(
                () => display.Drawn == 100, "for the points", () => camera.Publish(picture, evenLate: true));
            Bounds bounds = display.GetComponent<MeshFilter>().sharedMesh.bounds;
            Assert.AreEqual(1.5f, bounds.center.y, 1e-5f, "the axis z of an optical frame is up in its own axes");
            Assert.AreEqual(0, bounds.size.y, 1e-5f);
            Assert.AreEqual("depth_optical", display.FrameId);
            display.MaxPoints = 50;
            yield return _scene.Until(
                () => display.Drawn == 30, "for fewer points", () => camera.Publish(picture, evenLate: true));
            display.MaxRange = 1;
            yield return _scene.Until(
                () => display.Drawn == 0, "for the limit", () => camera.Publish(picture, evenLate: true));
        }
    }
}
