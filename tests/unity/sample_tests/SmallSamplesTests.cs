// SPDX-License-Identifier: Apache-2.0
using System.Collections;
using NUnit.Framework;
using Ros2Gateway.Samples.Robot;
using Ros2Gateway.Samples.Topics;
using Ros2Gateway.Unity;
using UnityEngine;
using UnityEngine.TestTools;

namespace Ros2Gateway.Samples.Tests
{
    /// <summary>The samples without a scene, next to a connection.</summary>
    [TestFixture]
    public sealed class SmallSamplesTests
    {
        private DemoScene _scene;

        [SetUp]
        public void SetUp()
        {
            _scene = new DemoScene();
            GatewaySettings settings = ScriptableObject.CreateInstance<GatewaySettings>();
            settings.Address = DemoScene.Address;
            _scene.Add<GatewayConnection>().Settings = settings;
        }

        [TearDown]
        public void TearDown()
        {
            _scene.Dispose();
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator TextsComeBack()
        {
            TopicsSample sample = _scene.Add<TopicsSample>();
            _scene.Begin();
            yield return _scene.Until(() => sample.Heard != null, "for a text");
            StringAssert.StartsWith("hello ", sample.Heard);
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator ARobotStandsBelowItsFrame()
        {
            _scene.Add<RobotSample>();
            _scene.Begin();
            yield return null;
            RobotDescriptionDisplay robot = _scene.Root.GetComponentInChildren<RobotDescriptionDisplay>(true);
            Assert.AreEqual("odom", robot.GetComponentInParent<FixedFrame>().Frame);
        }
    }
}
