// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections;
using System.Diagnostics;
using System.IO;
using System.Linq;
using System.Reflection;
using NUnit.Framework;
using Ros2Gateway.Unity;
using UnityEditor;
using UnityEngine;
using UnityEngine.Stage;
using UnityEngine.TestTools;

namespace Ros2Gateway.Editor.Tests
{
    /// <summary>Someone clicks in the window of messages, with the live gateway behind it.</summary>
    [TestFixture]
    public sealed class MessagesWindowTests
    {
        private const string Limit = "nav2_msgs/msg/SpeedLimit";
        private const string Goal = "nav2_msgs/action/NavigateToPose";
        private const int TimeoutMilliseconds = 120000; // a machine may be busy with other things

        private GatewaySettings _settings;
        private MessagesWindow _window;
        private string _folder;

        [SetUp]
        public void SetUp()
        {
            _folder = Path.Combine(Path.GetTempPath(), "window" + Guid.NewGuid().ToString("N"));
            _settings = ScriptableObject.CreateInstance<GatewaySettings>();
            _settings.Address = Environment.GetEnvironmentVariable("ROS2GATEWAY_TEST_URL") ?? "ws://127.0.0.1:9";
            _window = EditorWindow.GetWindow<MessagesWindow>("messages");
            SerializedObject window = new SerializedObject(_window);
            window.FindProperty("_settings").objectReferenceValue = _settings;
            window.ApplyModifiedProperties();
            Inspector.Write("Folder", _folder);
            Inspector.Write("Find a type", "");
            Inspector.Write("Assembly", "Robot.Messages");
        }

        [TearDown]
        public void TearDown()
        {
            UnityEngine.Object.DestroyImmediate(_window);
            UnityEngine.Object.DestroyImmediate(_settings);
            if (Directory.Exists(_folder))
            {
                Directory.Delete(_folder, true);
            }
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator Types_of_the_robot_are_chosen_and_generated_and_taken_back()
        {
            NeedsGateway();
            Look("Connect");
            yield return Until(() => Inspector.Toggles.ContainsKey(Limit));
            Assert.IsFalse(Inspector.Toggles.Keys.Any(each => each.StartsWith("nav_msgs/")), "the package has these");
            Look(Limit);
            Look(Goal);
            Look("Generate");
            yield return Until(() => Inspector.Words.Any(words => words.StartsWith("3 files of ")));
            StringAssert.Contains("class SpeedLimitMsg", File.ReadAllText(Path.Combine(_folder, "Nav2Msgs.cs")));
            StringAssert.Contains("NavigateToPoseGoal.Type", File.ReadAllText(Path.Combine(_folder, "MessageRegistration.cs")));
            Look();
            Assert.IsTrue(Inspector.Toggles[Limit]);
            Look(Goal);
            Look("Generate");
            yield return Until(() => Inspector.Words.Any(words => words.StartsWith("2 files of ")));
            StringAssert.DoesNotContain("NavigateToPose", File.ReadAllText(Path.Combine(_folder, "Nav2Msgs.cs")));
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator A_type_says_what_has_it_and_is_found_by_a_part_of_its_name()
        {
            NeedsGateway();
            Look("Connect");
            yield return Until(() => Inspector.Toggles.Keys.Any(label => label.Contains("   /fibonacci")));
            Inspector.Write("Find a type", "sPeedLim");
            yield return Until(() => Inspector.Toggles.Count == 1 && Inspector.Toggles.ContainsKey(Limit));
            Inspector.Write("Find a type", "nav_msgs/msg/Odometry");
            Look();
            Assert.AreEqual(0, Inspector.Toggles.Count);
            StringAssert.Contains("have classes", Inspector.Words.Last());
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator A_file_of_somebody_else_is_named_and_stays()
        {
            NeedsGateway();
            Directory.CreateDirectory(_folder);
            File.WriteAllText(Path.Combine(_folder, "Nav2Msgs.cs"), "mine");
            Look("Connect");
            yield return Until(() => Inspector.Toggles.ContainsKey(Limit));
            Look("Generate");
            Look();
            CollectionAssert.Contains(Inspector.Words, "no type is chosen");
            Look(Limit);
            Look("Generate");
            yield return Until(() => Inspector.Words.Any(words => words.Contains("would be overwritten")));
            Assert.AreEqual("mine", File.ReadAllText(Path.Combine(_folder, "Nav2Msgs.cs")));
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator A_name_that_no_assembly_can_have_is_refused_by_the_gateway_in_words()
        {
            NeedsGateway();
            Look("Connect");
            yield return Until(() => Inspector.Toggles.ContainsKey(Limit));
            Inspector.Write("Assembly", "my messages");
            Look(Limit);
            Look("Generate");
            yield return Until(() => Inspector.Words.Any(words => words.StartsWith("expected a name such as Robot.Messages")));
            Assert.IsFalse(Directory.Exists(_folder));
        }

        [Test]
        public void A_closed_window_leaves_nothing_in_the_editors_update()
        {
            Look();
            StringAssert.Contains(_settings.Address, Inspector.Words[0]);
            Look("Connect");
            Assert.IsNotNull(EditorApplication.update);
            UnityEngine.Object.DestroyImmediate(_window);
            Assert.IsNull(EditorApplication.update);
        }

        private static void NeedsGateway()
        {
            if (Environment.GetEnvironmentVariable("ROS2GATEWAY_TEST_URL") == null)
            {
                Assert.Ignore("needs a gateway: set ROS2GATEWAY_TEST_URL");
            }
        }

        private void Look(string click = null)
        {
            MethodInfo draw = typeof(MessagesWindow).GetMethod("OnGUI", BindingFlags.Instance | BindingFlags.NonPublic);
            string label = click == null ? null : Inspector.Toggles.Keys.FirstOrDefault(each => each.StartsWith(click)) ?? click;
            Inspector.Look(() => draw.Invoke(_window, null), label);
        }

        /// <summary>Goes on as the editor does: its update, and a look at the window.</summary>
        private IEnumerator Until(Func<bool> holds)
        {
            Stopwatch watch = Stopwatch.StartNew();
            while (!holds())
            {
                string shown = string.Join(" | ", Inspector.Words);
                Assert.Less(watch.ElapsedMilliseconds, TimeoutMilliseconds, shown);
                if (EditorApplication.update != null)
                {
                    EditorApplication.update();
                }
                Look();
                yield return null;
            }
        }
    }
}
