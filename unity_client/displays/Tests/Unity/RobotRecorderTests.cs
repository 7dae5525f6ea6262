// SPDX-License-Identifier: Apache-2.0
using System.Collections;
using System.Collections.Generic;
using NUnit.Framework;
using UnityEngine.TestTools;

namespace Ros2Gateway.Unity.Tests
{
    /// <summary>Recordings of a live gateway, as a scene starts and stops them.</summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class RobotRecorderTests
    {
        private DisplayScene _scene;

        [SetUp]
        public void SetUp()
        {
            _scene = new DisplayScene();
            _scene.Connect();
        }

        [TearDown]
        public void TearDown() => _scene.Dispose();

        [UnityTest]
        public IEnumerator ARecordingIsStartedMarkedAndStopped()
        {
            List<string> heard = new();
            RobotRecorder recorder = _scene.Display<RobotRecorder>(setUp: made =>
            {
                made.Topics = new[] { "/odom" };
                made.Task = "pick";
                made.StatusChanged += heard.Add;
            });
            yield return _scene.Until(() => recorder.State != null, "for the state");
            Assert.IsFalse(recorder.IsRecording);
            recorder.StartRecording();
            yield return _scene.Until(() => recorder.IsRecording, "for the start");
            yield return _scene.Until(() => recorder.State["messages"].AsLong() > 0, "for messages");
            Assert.AreEqual(1, recorder.State["topics"].AsLong(), "/odom alone");
            recorder.StartRecording();
            yield return _scene.Until(() => recorder.Status.Contains("stop it first"), "for the refusal of a second one");
            recorder.Mark("now");
            yield return _scene.Until(() => recorder.State["action"].AsString() == "mark", "for the mark");
            recorder.StopRecording();
            yield return _scene.Until(() => recorder.State["state"].AsString() == "stopped", "for the end");
            StringAssert.StartsWith("stopped recording_", recorder.Status);
            CollectionAssert.Contains(heard, recorder.Status);
            recorder.Mark("late");
            yield return _scene.Until(() => !recorder.Status.StartsWith("stopped"), "for the refusal of a late mark");
            recorder.enabled = false;
            Assert.IsNull(recorder.State);
        }
    }
}
