// SPDX-License-Identifier: Apache-2.0
using System.Collections;
using System.Collections.Generic;
using NUnit.Framework;
using Ros2Gateway.Messages.NavMsgs;
using Ros2Gateway.Messages.StdMsgs;
using UnityEngine;
using UnityEngine.TestTools;

namespace Ros2Gateway.Unity.Tests
{
    [TestFixture]
    public sealed class TextScreenTests
    {
        private DisplayScene _scene;

        [SetUp]
        public void SetUp() => _scene = new DisplayScene();

        [TearDown]
        public void TearDown() => _scene.Dispose();

        [UnityTest]
        public IEnumerator AMessageIsWrittenToTheTextMeshBesideIt()
        {
            TextScreen screen = _scene.Display<TextScreen>(
                setUp: made => made.gameObject.AddComponent<TextMesh>());
            TextMesh mesh = screen.GetComponent<TextMesh>();
            screen.Show(new StringMsg { data = "<b>hello</b>" });
            yield return _scene.Until(() => mesh.text == "<b>hello</b>", "for the text");
            Assert.IsFalse(mesh.richText, "tags in a message are text");
        }

        [UnityTest]
        public IEnumerator LinesAreLimited()
        {
            TextScreen screen = _scene.Display<TextScreen>(setUp: made => made.MaxLines = 3);
            screen.Show(new OdometryMsg());
            yield return _scene.Until(() => screen.Output.Text != null, "for the text");
            Assert.AreEqual(4, screen.Output.Text.Split('\n').Length);
        }

        [UnityTest]
        public IEnumerator OfManyMessagesFewAreWrittenAndTheLastAlways()
        {
            List<string> texts = new();
            TextScreen screen = _scene.Display<TextScreen>(
                setUp: made => made.Output.OnChanged.AddListener(texts.Add));
            float began = Time.unscaledTime;
            for (int i = 0; i <= 50; i++)
            {
                screen.Show(new StringMsg { data = i.ToString() });
                yield return null;
            }
            yield return _scene.Until(() => texts.Contains("50"), "for the last");
            float tenths = (Time.unscaledTime - began) * 10;
            Assert.LessOrEqual(texts.Count, Mathf.CeilToInt(tenths) + 1);
        }

#if ROS2GATEWAY_UGUI
        [UnityTest]
        public IEnumerator AMessageIsWrittenToATextBelowIt()
        {
            GameObject below = new("label");
            UnityEngine.UI.Text label = below.AddComponent<UnityEngine.UI.Text>();
            TextScreen screen = _scene.Display<TextScreen>(
                setUp: made => below.transform.SetParent(made.transform, false));
            screen.Show(new StringMsg { data = "hello" });
            yield return _scene.Until(() => label.text == "hello", "for the text");
        }
#endif

#if ROS2GATEWAY_TMP
        [UnityTest]
        public IEnumerator AMessageIsWrittenToATextMeshProWhoseTagsAreNotObeyed()
        {
            GameObject below = new("label");
            TMPro.TMP_Text label = below.AddComponent<TMPro.TextMeshPro>();
            label.richText = true;
            TextScreen screen = _scene.Display<TextScreen>(
                setUp: made => below.transform.SetParent(made.transform, false));
            screen.Show(new StringMsg { data = "<b>hello</b>" });
            yield return _scene.Until(() => label.text == "<b>hello</b>", "for the text");
            Assert.IsFalse(label.richText);
            Assert.IsFalse(label.parseCtrlCharacters);
        }
#endif
    }
}
