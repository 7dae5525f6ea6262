// SPDX-License-Identifier: Apache-2.0
using System.Collections;
using NUnit.Framework;
using Ros2Gateway.Messages.RclInterfaces;
using UnityEngine.TestTools;

namespace Ros2Gateway.Unity.Tests
{
    [TestFixture]
    public sealed class LogScreenTests
    {
        private DisplayScene _scene;

        [SetUp]
        public void SetUp() => _scene = new DisplayScene();

        [TearDown]
        public void TearDown() => _scene.Dispose();

        [UnityTest]
        public IEnumerator LinesHaveTheColoursOfTheirLevelAndTheNewestIsTheLast()
        {
            LogScreen screen = _scene.Display<LogScreen>();
            screen.Add(LogLevel.Warning, "base", "battery is low");
            screen.Add(LogLevel.Fatal, "base", "battery is empty");
            yield return _scene.Until(() => screen.Output.Text != null, "for the lines");
            Assert.AreEqual(
                "<color=#ffd040>WARNING base: battery is low</color>\n"
                + "<color=#ff60ff>FATAL base: battery is empty</color>",
                screen.Output.Text);
        }

        [UnityTest]
        public IEnumerator OnlyTheNewestLinesOfTheWantedLevelsAreKept()
        {
            LogScreen screen = _scene.Display<LogScreen>(setUp: made =>
            {
                made.MaxLines = 3;
                made.MinLevel = LogLevel.Warning;
            });
            for (int i = 0; i < 10; i++)
            {
                screen.Add(LogLevel.Error, "node", "error " + i);
                screen.Add(LogLevel.Info, "node", "info " + i);
            }
            yield return _scene.Until(() => screen.Output.Text != null, "for the lines");
            string[] lines = screen.Output.Text.Split('\n');
            Assert.AreEqual(3, lines.Length);
            StringAssert.Contains("error 7", lines[0]);
            StringAssert.Contains("error 9", lines[2]);
        }

        [UnityTest]
        public IEnumerator TagsAndLineBreaksInALineAreText()
        {
            LogScreen screen = _scene.Display<LogScreen>();
            screen.Add(LogLevel.Info, "node", "<size=500>a\nb</size>" + new string('x', 1000));
            yield return _scene.Until(() => screen.Output.Text != null, "for the line");
            StringAssert.DoesNotContain("<size", screen.Output.Text);
            StringAssert.DoesNotContain("\n", screen.Output.Text);
            Assert.Less(screen.Output.Text.Length, 300);
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator RosoutAndTheClientsEventsStandTogether()
        {
            _scene.Connect();
            LogScreen screen = _scene.Display<LogScreen>(setUp: made => made.MaxLines = 100);
            // refused by the gateway in words: an event
            LogAssert.ignoreFailingMessages = true;
            _scene.Connection.Client.Subscribe<LogMsg>("/odom");
            Publisher<LogMsg> node = _scene.Connection.Client.Advertise<LogMsg>("/rosout");
            LogMsg message = new() { level = LogMsg.WARN, name = "test_node", msg = "wheel slips" };
            yield return _scene.Until(
                () => Shows(screen, "WARNING test_node: wheel slips") && Shows(screen, "gateway: subscribe"),
                "for both", () => node.Publish(message));
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator AConnectionThatComesLaterIsFoundAndWhatItSaidBeforeIsShown()
        {
            LogScreen screen = _scene.Display<LogScreen>();
            yield return null;
            GatewayConnection connection = _scene.Connect();
            yield return _scene.Until(() => connection.Client.IsConnected, "to be connected");
            yield return _scene.Until(() => Shows(screen, "INFO gateway: connected to"), "for the event");
        }

        private static bool Shows(LogScreen screen, string words) =>
            screen.Output.Text != null && screen.Output.Text.Contains(words);
    }
}
