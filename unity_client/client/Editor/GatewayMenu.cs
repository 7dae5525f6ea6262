// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Unity;
using UnityEditor;
using UnityEngine;

namespace Ros2Gateway.Editor
{
    /// <summary>GameObject > ROS 2 Gateway: ready objects for a scene.</summary>
    public static class GatewayMenu
    {
        private const string Path = "GameObject/ROS 2 Gateway/";
        private const int Priority = 10; // among the other kinds of objects, as Unity's manual asks for

        /// <summary>The connection that all others find.</summary>
        [MenuItem(Path + "Connection", false, Priority)]
        public static void Connection(MenuCommand command) =>
            Finish(new GameObject("Gateway Connection", typeof(GatewayConnection)), command);

        /// <summary>Any topic, which is heard.</summary>
        [MenuItem(Path + "Topic Subscriber", false, Priority)]
        public static void Subscriber(MenuCommand command) =>
            Finish(new GameObject("Topic Subscriber", typeof(TopicSubscriber)), command);

        /// <summary>Any topic, which is written.</summary>
        [MenuItem(Path + "Topic Publisher", false, Priority)]
        public static void Publisher(MenuCommand command) =>
            Finish(new GameObject("Topic Publisher", typeof(TopicPublisher)), command);

        /// <summary>Puts what was made below the chosen object, so that it can be undone, and chooses it.</summary>
        public static void Finish(Component on, MenuCommand command) => Finish(on.gameObject, command);

        private static void Finish(GameObject made, MenuCommand command)
        {
            GameObjectUtility.SetParentAndAlign(made, command.context as GameObject);
            Undo.RegisterCreatedObjectUndo(made, "Create " + made.name);
            Selection.activeObject = made;
        }
    }
}
