// SPDX-License-Identifier: Apache-2.0
using NUnit.Framework;
using Ros2Gateway.Unity;
using UnityEditor;
using UnityEngine;
using UnityEngine.TestTools;

namespace Ros2Gateway.Editor.Tests
{
    /// <summary>The inspectors open, draw and close. The menu makes what it says.</summary>
    [TestFixture]
    public sealed class InspectorTests
    {
        [Test]
        public void InspectorsDrawWhereNothingIsConnected()
        {
            GameObject holder = new("topics");
            holder.SetActive(false);
            Draw(holder.AddComponent<GatewayConnection>(), typeof(GatewayConnectionInspector));
            Draw(holder.AddComponent<TopicSubscriber>(), typeof(TopicSubscriberInspector));
            Draw(holder.AddComponent<TopicPublisher>(), typeof(TopicPublisherInspector));
            Object.DestroyImmediate(holder);
            GatewaySettings settings = ScriptableObject.CreateInstance<GatewaySettings>();
            Draw(settings, typeof(GatewaySettingsInspector));
            Object.DestroyImmediate(settings);
        }

        [Test]
        public void TheMenuMakesWhatItSays()
        {
            LogAssert.ignoreFailingMessages = true; // the connection may look for a gateway at once
            GameObject parent = new("parent");
            parent.SetActive(false); // nothing in it begins
            MenuCommand command = new(parent);
            Made<GatewayConnection>(() => GatewayMenu.Connection(command), parent);
            Made<TopicSubscriber>(() => GatewayMenu.Subscriber(command), parent);
            Made<TopicPublisher>(() => GatewayMenu.Publisher(command), parent);
            Object.DestroyImmediate(parent);
        }

        private static void Draw(Object target, System.Type inspector)
        {
            UnityEditor.Editor editor = UnityEditor.Editor.CreateEditor(target, inspector);
            editor.OnInspectorGUI();
            Object.DestroyImmediate(editor);
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
