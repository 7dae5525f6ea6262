// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections;
using System.Diagnostics;
using System.Text.RegularExpressions;
using NUnit.Framework;
using Ros2Gateway.Messages.SensorMsgs;
using Ros2Gateway.Unity;
using UnityEngine;
using UnityEngine.Stage;
using UnityEngine.TestTools;

namespace Ros2Gateway.Editor.Tests
{
    /// <summary>Textures are published with graphics cards of all kinds.</summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class TextureReadbackTests
    {
        private const int TimeoutMilliseconds = 120000; // a machine may be busy with other things

        private GameObject _holder;
        private GatewaySettings _settings;
        private TopicPublisher _publisher;
        private CompressedImageMsg _picture;
        private Texture _texture;

        [SetUp]
        public void SetUp()
        {
            _settings = ScriptableObject.CreateInstance<GatewaySettings>();
            _settings.Address = Environment.GetEnvironmentVariable("ROS2GATEWAY_TEST_URL");
            _holder = new GameObject("holder");
            _holder.SetActive(false);
            GatewayConnection connection = _holder.AddComponent<GatewayConnection>();
            connection.Settings = _settings;
            _publisher = _holder.AddComponent<TopicPublisher>();
            _publisher.Topic = "/read_back";
            _publisher.Type = CompressedImageMsg.Type;
            _texture = new RenderTexture(1280, 720, 0);
            _picture = null;
            _holder.SetActive(true);
            connection.Client.Subscribe<CompressedImageMsg>("/read_back", picture => _picture = picture);
        }

        [TearDown]
        public void TearDown()
        {
            Gpu.ReadsBack = true;
            Gpu.Fails = false;
            UnityEngine.Object.DestroyImmediate(_holder);
            UnityEngine.Object.DestroyImmediate(_settings);
            UnityEngine.Object.DestroyImmediate(_texture);
        }

        [UnityTest]
        public IEnumerator A_texture_is_published_whatever_the_graphics_card_can([Values(true, false)] bool readsBack)
        {
            Gpu.ReadsBack = readsBack;
            yield return Until(() => Publishes() && _picture != null);
            Assert.AreEqual("jpeg", _picture.format);
            Assert.AreEqual(640, Width(_picture.data), "the publisher's bound");
        }

        [UnityTest]
        public IEnumerator One_picture_is_under_way_at_a_time_and_one_that_fails_does_not_block_the_next()
        {
            yield return Until(Publishes);
            Assert.IsFalse(_publisher.PublishTexture(_texture), "one is under way");
            Gpu.Fails = true;
            LogAssert.Expect(LogType.Warning, new Regex("/read_back: the GPU did not return an image"));
            yield return Until(Publishes);
            yield return Until(() => _publisher.Dropped == 1);
            Gpu.Fails = false;
            _picture = null;
            yield return Until(() => Publishes() && _picture != null);
        }

        [UnityTest]
        public IEnumerator After_failures_in_a_row_the_main_thread_reads_the_picture()
        {
            LogAssert.Expect(LogType.Warning, new Regex("which is dropped$"));
            LogAssert.Expect(LogType.Warning, new Regex("from now on the main thread waits for the GPU"));
            Gpu.Fails = true;
            yield return Until(() => Publishes() && _picture != null);
            Assert.AreEqual(5, _publisher.Dropped);
        }

        [UnityTest]
        public IEnumerator A_camera_is_rendered_when_a_picture_is_due()
        {
            Camera camera = _holder.AddComponent<Camera>();
            _publisher.Rate = 2;
            TexturePublisher seen = Sees(camera, true);
            int before = Gpu.Rendered;
            Assert.IsFalse(camera.enabled);
            yield return Until(() => _picture != null);
            Assert.AreEqual(before + 1, Gpu.Rendered);
            _picture = null;
            yield return Until(() => _picture != null);
            Assert.AreEqual(before + 2, Gpu.Rendered);
            seen.enabled = false;
            Assert.IsTrue(camera.enabled);
            Assert.IsNull(camera.targetTexture);
        }

        [UnityTest]
        public IEnumerator A_camera_that_others_show_or_that_is_to_render_in_each_frame_stays_enabled(
            [Values(true, false)] bool isShown)
        {
            Camera camera = _holder.AddComponent<Camera>();
            camera.targetTexture = isShown ? (RenderTexture)_texture : null;
            int before = Gpu.Rendered;
            Sees(camera, isShown);
            yield return Until(() => _picture != null);
            Assert.IsTrue(camera.enabled);
            Assert.AreEqual(before, Gpu.Rendered);
        }

        private TexturePublisher Sees(Camera camera, bool rendersOnDemand)
        {
            _holder.SetActive(false);
            TexturePublisher seen = _holder.AddComponent<TexturePublisher>();
            seen.Camera = camera;
            seen.RendersOnDemand = rendersOnDemand;
            _holder.SetActive(true);
            return seen;
        }

        private bool Publishes()
        {
            return _publisher.PublishTexture(_texture);
        }

        private static int Width(byte[] jpeg)
        {
            Texture2D texture = new Texture2D(2, 2);
            texture.LoadImage(jpeg);
            int width = texture.width;
            UnityEngine.Object.DestroyImmediate(texture);
            return width;
        }

        private static IEnumerator Until(Func<bool> holds)
        {
            Stopwatch watch = Stopwatch.StartNew();
            while (!holds())
            {
                Assert.Less(watch.ElapsedMilliseconds, TimeoutMilliseconds, "waited in vain");
                yield return null;
            }
        }
    }
}
