// SPDX-License-Identifier: Apache-2.0
using System.Collections;
using System.Collections.Generic;
using NUnit.Framework;
using Ros2Gateway.Messages.SensorMsgs;
using Ros2Gateway.Tests;
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
            yield return Shown(screen, 640);
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
            yield return Shown(screen, 640);
            Assert.AreEqual(1, screen.transform.localScale.x);
        }

        [UnityTest]
        public IEnumerator TheTextureIsUsedAgainForPicturesOfOtherSizes()
        {
            ImageScreen screen = Screen();
            screen.Show(Jpeg(640, 480));
            yield return Shown(screen, 640);
            Texture2D texture = screen.Texture;
            screen.Show(Jpeg(320, 200));
            yield return Shown(screen, 320);
            Assert.AreSame(texture, screen.Texture);
            Assert.AreEqual(320, texture.width);
        }

        [UnityTest]
        public IEnumerator OfSeveralPicturesInAFrameOnlyTheNewestIsDecoded()
        {
            ImageScreen screen = Screen();
            screen.Show(new CompressedImageMsg { format = "nonsense", data = new byte[10] });
            screen.Show(Jpeg(64, 48));
            yield return Shown(screen, 64);
            Assert.AreEqual(64, screen.Texture.width);
            Assert.IsFalse(_scene.HasLogged("nonsense"));
        }

        [UnityTest]
        public IEnumerator PicturesThatStayAwayAreTold()
        {
            GameObject below = new("status");
            TextMesh status = below.AddComponent<TextMesh>();
            List<bool> told = new();
            _original.color = Color.yellow;
            ImageScreen screen = Screen(made =>
            {
                below.transform.SetParent(made.transform, false);
                made.StaleAfter = 0.1f;
                made.OnStale.AddListener(told.Add);
            });
            yield return null;
            Assert.IsTrue(screen.IsStale);
            Assert.AreEqual("no image", status.text);
            screen.Show(Jpeg(64, 48));
            yield return Shown(screen, 64);
            Assert.AreEqual("", status.text);
            Assert.AreEqual(Color.yellow, _renderer.sharedMaterial.color);
            CompressedImageMsg bad = new() { format = "h264", data = new byte[100] };
            yield return _scene.Until(() => screen.IsStale, "for it to be stale", () => screen.Show(bad));
            Assert.AreEqual("image is 0 s old", status.text);
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
            yield return _scene.Until(() => _scene.HasLogged("ImageScreen"), "for words");
            Assert.IsNull(screen.Texture);
            Assert.IsTrue(screen.IsStale);
            screen.Show(Jpeg(64, 48));
            yield return Shown(screen, 64);
            Assert.AreEqual(64, screen.Texture.width);
        }

        [UnityTest]
        public IEnumerator TheSameWarningIsLoggedOnce()
        {
            ImageScreen screen = Screen();
            for (int i = 0; i < 5; i++)
            {
                screen.Show(new CompressedImageMsg { format = "h264", data = new byte[100] });
                yield return null;
            }
            screen.Show(Jpeg(64, 48));
            yield return Shown(screen, 64);
            Assert.AreEqual(1, _scene.Logged.FindAll(text => text.Contains("JPEG and PNG only")).Count);
        }

        [UnityTest]
        public IEnumerator WhatItMadeIsDestroyedAndTheMaterialComesBack()
        {
            ImageScreen screen = Screen();
            screen.Show(Jpeg(64, 48));
            yield return Shown(screen, 64);
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
        public IEnumerator WithoutASurfaceItWarnsAndGoesOn()
        {
            ImageScreen screen = _scene.Display<ImageScreen>();
            screen.Show(Jpeg(64, 48));
            yield return Shown(screen, 64);
            Assert.AreEqual(64, screen.Texture.width);
        }

        [UnityTest]
        public IEnumerator APictureIsInItsColoursAndTheRightWayUp()
        {
            ImageScreen screen = Screen();
            screen.Show(new CompressedImageMsg { format = "jpeg", data = SmallPictures.RedAboveBlue() });
            yield return Shown(screen, SmallPictures.Width);
            Assert.AreEqual(TextureFormat.RGBA32, screen.Texture.format);
            Color32 above = screen.Texture.GetPixel(0, SmallPictures.Height - 1);
            Color32 below = screen.Texture.GetPixel(SmallPictures.Width - 1, 0);
            Assert.AreEqual("253 1 0 255", above.r + " " + above.g + " " + above.b + " " + above.a);
            Assert.AreEqual("0 0 254 255", below.r + " " + below.g + " " + below.b + " " + below.a);
        }

        [UnityTest]
        public IEnumerator ProgressivePicturesAndPngsAreLeftToUnity()
        {
            ImageScreen screen = Screen();
            screen.Show(new CompressedImageMsg { format = "jpeg", data = SmallPictures.Progressive() });
            yield return Shown(screen, SmallPictures.Width);
            Assert.AreEqual(TextureFormat.RGB24, screen.Texture.format, "what LoadImage makes of JPEGs");
            Texture2D texture = screen.Texture;
            screen.Show(new CompressedImageMsg { format = "png", data = PngHeader(20, 30) });
            yield return Shown(screen, 20);
            Assert.AreEqual(TextureFormat.ARGB32, screen.Texture.format);
            screen.Show(new CompressedImageMsg { format = "jpeg", data = SmallPictures.RedAboveBlue() });
            yield return Shown(screen, SmallPictures.Width);
            Assert.AreEqual(TextureFormat.RGBA32, screen.Texture.format);
            Assert.AreSame(texture, screen.Texture);
        }

        [UnityTest]
        public IEnumerator ADamagedPictureIsToldWithItsPlaceAndTheOneBeforeStays()
        {
            ImageScreen screen = Screen();
            screen.Show(Jpeg(64, 48));
            yield return Shown(screen, 64);
            byte[] damaged = SmallPictures.RedAboveBlue();
            System.Array.Resize(ref damaged, damaged.Length - 10);
            screen.Show(new CompressedImageMsg { format = "jpeg", data = damaged });
            yield return _scene.Until(() => _scene.HasLogged("is damaged"), "for words");
            Assert.IsTrue(_scene.HasLogged(
                "an image of format \"jpeg\" is damaged: the data end within the picture (byte "
                + damaged.Length + ")"));
            Assert.AreEqual(64, screen.Texture.width);
        }

        [UnityTest]
        public IEnumerator NoMorePixelsAreAskedForThanTheCameraSees()
        {
            ImageScreen screen = Screen();
            TopicSubscriber subscriber = screen.Subscriber;
            yield return null;
            yield return null;
            Assert.AreEqual(0, subscriber.ShownSide, "without a camera nobody knows");
            Camera camera = _scene.Inactive("camera").AddComponent<Camera>();
            camera.tag = "MainCamera";
            camera.transform.position = new Vector3(0, 0, -10);
            camera.gameObject.SetActive(true);
            yield return _scene.Until(() => subscriber.ShownSide == 160, "for the smallest, from afar");
            camera.transform.position = new Vector3(0, 0, -1.5f); // 720 pixels are 1.15 m there
            yield return _scene.Until(() => subscriber.ShownSide == 640, "for more, from near");
            camera.transform.position = Vector3.zero;
            yield return _scene.Until(() => subscriber.ShownSide == 0, "for all, in the midst of it");
            camera.orthographic = true;
            camera.orthographicSize = 2;
            yield return _scene.Until(() => subscriber.ShownSide == 240, "for a quarter of the height");
            screen.enabled = false;
            Assert.AreEqual(0, subscriber.ShownSide, "others may show them");
            screen.enabled = true;
            yield return _scene.Until(() => subscriber.ShownSide == 240, "for a quarter again");
            screen.ShrinksToView = false;
            yield return _scene.Until(() => subscriber.ShownSide == 0, "for all, on demand");
        }

#if ROS2GATEWAY_UGUI
        [UnityTest]
        public IEnumerator OnAnOverlayAUnitIsAPixel()
        {
            GameObject canvas = _scene.Inactive("canvas");
            canvas.AddComponent<Canvas>().renderMode = RenderMode.ScreenSpaceOverlay;
            canvas.SetActive(true);
            ImageScreen screen = _scene.Display<ImageScreen>(setUp: made =>
            {
                made.gameObject.AddComponent<UnityEngine.UI.RawImage>();
                made.transform.SetParent(canvas.transform, false);
                ((RectTransform)made.transform).sizeDelta = new Vector2(300, 200);
                made.transform.localScale = new Vector3(2, 2, 1);
            });
            yield return _scene.Until(() => screen.Subscriber.ShownSide == 960, "for 600 pixels and a quarter");
        }

        [UnityTest]
        public IEnumerator APictureIsShownOnARawImageWithItsAspect()
        {
            ImageScreen screen = _scene.Display<ImageScreen>(
                setUp: made => made.gameObject.AddComponent<UnityEngine.UI.RawImage>());
            screen.Show(Jpeg(640, 480));
            yield return Shown(screen, 640);
            Assert.AreSame(screen.Texture, screen.GetComponent<UnityEngine.UI.RawImage>().texture);
            var fitter = screen.GetComponent<UnityEngine.UI.AspectRatioFitter>();
            Assert.AreEqual(640f / 480, fitter.aspectRatio, 1e-5);
        }
#endif

        [UnityTest]
        public IEnumerator UnitysDefaultMaterialGivesWayToOneThatNoLightDarkens(
            [Values("Default-Material", "Lit", "mine")] string name)
        {
            Shader lit = name == "Lit" ? Shader.Find("Universal Render Pipeline/Lit") : null;
            if (name == "Lit" && lit == null)
            {
                Assert.Ignore("needs URP");
            }
            _original.shader = lit != null ? lit : _original.shader;
            _original.name = name;
            _original.color = Color.yellow;
            ImageScreen screen = Screen();
            screen.Show(Jpeg(64, 48));
            yield return Shown(screen, 64);
            bool isKept = _renderer.sharedMaterial.color == Color.yellow;
            Assert.AreEqual(name == "mine", isKept);
        }

        [UnityTest]
        public IEnumerator AMaterialOfTheProjectWithTheNameOfUrpsIsKept()
        {
            _original.name = "Lit";
            _original.color = Color.yellow;
            ImageScreen screen = Screen();
            screen.Show(Jpeg(64, 48));
            yield return Shown(screen, 64);
            Assert.AreEqual(Color.yellow, _renderer.sharedMaterial.color);
        }

        private ImageScreen Screen(System.Action<ImageScreen> setUp = null) => _scene.Display<ImageScreen>(setUp: made =>
        {
            _renderer = made.gameObject.AddComponent<MeshRenderer>();
            _renderer.sharedMaterial = _original;
            if (setUp != null)
            {
                setUp(made);
            }
        });

        // Another thread decodes it, as soon as it can.
        private IEnumerator Shown(ImageScreen screen, int width) => _scene.Until(
            () => screen.Texture != null && screen.Texture.width == width && !screen.IsStale, "for a picture");

        private static CompressedImageMsg Jpeg(int width, int height)
        {
            Texture2D texture = new(width, height);
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
