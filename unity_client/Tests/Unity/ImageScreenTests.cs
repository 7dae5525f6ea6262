// SPDX-License-Identifier: Apache-2.0
using System.Collections;
using System.Collections.Generic;
using NUnit.Framework;
using Ros2Gateway.Messages.SensorMsgs;
using UnityEngine;
using UnityEngine.TestTools;

namespace Ros2Gateway.Unity.Tests
{
    [TestFixture]
    public sealed class ImageScreenTests
    {
        private DisplayScene _scene;
        private MeshRenderer _renderer;
        private Material _original;

        [SetUp]
        public void SetUp()
        {
            _scene = new DisplayScene();
            _original = new Material(Shader.Find("Unlit/Texture"));
        }

        [TearDown]
        public void TearDown()
        {
            _scene.Dispose();
            Object.DestroyImmediate(_original);
        }

        [UnityTest]
        public IEnumerator APictureIsShownOnTheRendererWithItsAspect()
        {
            ImageScreen screen = Screen();
            screen.transform.localScale = new Vector3(5, 2, 1);
            screen.Show(Jpeg(640, 480));
            yield return null;
            Assert.AreEqual(640, screen.Texture.width);
            Assert.AreSame(screen.Texture, _renderer.sharedMaterial.mainTexture);
            Assert.AreEqual(2 * 640f / 480, screen.transform.localScale.x, 1e-5);
            Assert.AreEqual(2, screen.transform.localScale.y);
            Assert.IsFalse(screen.IsStale);
        }

        [UnityTest]
        public IEnumerator TheAspectStaysOnDemand()
        {
            ImageScreen screen = Screen();
            screen.KeepAspect = false;
            screen.Show(Jpeg(640, 480));
            yield return null;
            Assert.AreEqual(1, screen.transform.localScale.x);
        }

        [UnityTest]
        public IEnumerator TheTextureIsUsedAgainForPicturesOfOtherSizes()
        {
            ImageScreen screen = Screen();
            screen.Show(Jpeg(640, 480));
            yield return null;
            Texture2D texture = screen.Texture;
            screen.Show(Jpeg(320, 200));
            yield return null;
            Assert.AreSame(texture, screen.Texture);
            Assert.AreEqual(320, texture.width);
        }

        [UnityTest]
        public IEnumerator OfSeveralPicturesInAFrameOnlyTheNewestIsDecoded()
        {
            ImageScreen screen = Screen();
            screen.Show(new CompressedImageMsg { format = "nonsense", data = new byte[10] });
            screen.Show(Jpeg(64, 48));
            yield return null;
            Assert.AreEqual(64, screen.Texture.width);
            Assert.IsFalse(_scene.HasLogged("nonsense"));
        }

        [UnityTest]
        public IEnumerator PicturesThatStayAwayAreTold()
        {
            GameObject below = new GameObject("status");
            TextMesh status = below.AddComponent<TextMesh>();
            List<bool> told = new List<bool>();
            _original.color = Color.yellow;
            ImageScreen screen = Screen(made =>
            {
                below.transform.SetParent(made.transform, false);
                made.StaleAfter = 0.1f;
                made.OnStale.AddListener(told.Add);
            });
            yield return null;
            Assert.IsTrue(screen.IsStale);
            Assert.AreEqual("no picture", status.text);
            screen.Show(Jpeg(64, 48));
            yield return null;
            Assert.AreEqual("", status.text);
            Assert.AreEqual(Color.yellow, _renderer.sharedMaterial.color);
            CompressedImageMsg bad = new CompressedImageMsg { format = "h264", data = new byte[100] };
            yield return _scene.Until(() => screen.IsStale, "for it to be stale", () => screen.Show(bad));
            Assert.AreEqual("picture is 0 s old", status.text);
            Assert.AreEqual(0.35f, _renderer.sharedMaterial.color.r);
            CollectionAssert.AreEqual(new[] { true, false, true }, told);
        }

        [UnityTest]
        public IEnumerator WhatIsNoPictureIsNotShown([Values(0, 1, 2, 3, 4, 5)] int kind)
        {
            byte[] jpeg = new Texture2D(8, 8).EncodeToJPG();
            byte[] truncated = new byte[20];
            System.Array.Copy(jpeg, truncated, truncated.Length);
            byte[][] bad =
            {
                null, new byte[0], new byte[] { 1, 2, 3 }, truncated, PngHeader(100000, 10), PngHeader(0, 10),
            };
            ImageScreen screen = Screen();
            screen.Show(new CompressedImageMsg { format = "jpeg", data = bad[kind] });
            yield return null;
            Assert.IsNull(screen.Texture);
            Assert.IsTrue(screen.IsStale);
            screen.Show(Jpeg(64, 48));
            yield return null;
            Assert.AreEqual(64, screen.Texture.width);
        }

        [UnityTest]
        public IEnumerator TheSameComplaintIsLoggedOnce()
        {
            ImageScreen screen = Screen();
            for (int i = 0; i < 5; i++)
            {
                screen.Show(new CompressedImageMsg { format = "h264", data = new byte[100] });
                yield return null;
            }
            Assert.AreEqual(1, _scene.Logged.FindAll(text => text.Contains("JPEG and PNG only")).Count);
        }

        [UnityTest]
        public IEnumerator WhatItMadeIsDestroyedAndTheMaterialComesBack()
        {
            ImageScreen screen = Screen();
            screen.Show(Jpeg(64, 48));
            yield return null;
            Texture2D texture = screen.Texture;
            Material copy = _renderer.sharedMaterial;
            Assert.AreNotSame(_original, copy);
            Object.Destroy(screen);
            yield return null;
            yield return null;
            Assert.IsTrue(texture == null);
            Assert.IsTrue(copy == null);
            Assert.AreSame(_original, _renderer.sharedMaterial);
            Assert.IsNull(_original.mainTexture);
        }

        [UnityTest]
        public IEnumerator WithoutASurfaceItComplainsAndGoesOn()
        {
            ImageScreen screen = _scene.Display<ImageScreen>();
            screen.Show(Jpeg(64, 48));
            yield return null;
            Assert.AreEqual(64, screen.Texture.width);
        }

#if ROS2GATEWAY_UGUI
        [UnityTest]
        public IEnumerator APictureIsShownOnARawImageWithItsAspect()
        {
            ImageScreen screen = _scene.Display<ImageScreen>(
                setUp: made => made.gameObject.AddComponent<UnityEngine.UI.RawImage>());
            screen.Show(Jpeg(640, 480));
            yield return null;
            Assert.AreSame(screen.Texture, screen.GetComponent<UnityEngine.UI.RawImage>().texture);
            var fitter = screen.GetComponent<UnityEngine.UI.AspectRatioFitter>();
            Assert.AreEqual(640f / 480, fitter.aspectRatio, 1e-5);
        }
#endif

        private ImageScreen Screen(System.Action<ImageScreen> setUp = null)
        {
            return _scene.Display<ImageScreen>(setUp: made =>
            {
                _renderer = made.gameObject.AddComponent<MeshRenderer>();
                _renderer.sharedMaterial = _original;
                if (setUp != null)
                {
                    setUp(made);
                }
            });
        }

        private static CompressedImageMsg Jpeg(int width, int height)
        {
            Texture2D texture = new Texture2D(width, height);
            byte[] jpeg = texture.EncodeToJPG();
            Object.DestroyImmediate(texture);
            return new CompressedImageMsg { format = "jpeg", data = jpeg };
        }

        private static byte[] PngHeader(int width, int height)
        {
            byte[] png = new byte[33];
            new byte[] { 0x89, 0x50, 0x4E, 0x47, 0x0D, 0x0A, 0x1A, 0x0A }.CopyTo(png, 0);
            new byte[] { 0, 0, 0, 13, 0x49, 0x48, 0x44, 0x52 }.CopyTo(png, 8);
            for (int i = 0; i < 4; i++)
            {
                png[16 + i] = (byte)(width >> (24 - 8 * i));
                png[20 + i] = (byte)(height >> (24 - 8 * i));
            }
            return png;
        }
    }
}
