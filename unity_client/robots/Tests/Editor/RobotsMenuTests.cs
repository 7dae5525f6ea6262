// SPDX-License-Identifier: Apache-2.0
using NUnit.Framework;
using Ros2Gateway.Unity;
using UnityEditor;
using UnityEngine;

namespace Ros2Gateway.Editor.Tests
{
    /// <summary>The menu makes what it says.</summary>
    [TestFixture]
    public sealed class RobotsMenuTests
    {
        [Test]
        public void TheMenuMakesARobot()
        {
            GameObject parent = new("parent");
            parent.SetActive(false); // nothing in it begins
            MenuCommand command = new(parent);
            Made<RobotDescriptionDisplay>(() => RobotsMenu.RobotDescriptionDisplay(command), parent);
            Assert.IsNotNull(((GameObject)Selection.activeObject).GetComponentInChildren<JointStateDisplay>(true));
            Object.DestroyImmediate(parent);
        }

        private static void Made<T>(System.Action make, GameObject parent)
            where T : Component
        {
            make();
            GameObject made = (GameObject)Selection.activeObject;
            Assert.IsNotNull(made.GetComponent<T>());
            Assert.AreSame(parent.transform, made.transform.parent);
        }
    }
}
