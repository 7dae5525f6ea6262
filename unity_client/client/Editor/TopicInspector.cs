// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;
using Ros2Gateway.Unity;
using UnityEditor;
using UnityEngine;

namespace Ros2Gateway.Editor
{
    /// <summary>
    /// The common part of the inspectors of subscribers and publishers: a topic from the live graph, a type from the
    /// catalogue, and what is wrong with them.
    /// </summary>
    public abstract class TopicInspector : UnityEditor.Editor
    {
        private const float ButtonWidth = 70;
        private const int MostFound = 40; // a longer menu does not help: search further

        private readonly TypeCatalogue _catalogue = new();
        private GraphDropdown _graph;
        private SerializedProperty _connection;
        private SerializedProperty _topic;
        private SerializedProperty _type;
        private string _search = "";

        /// <summary>Whether the type may be left to the gateway.</summary>
        protected abstract bool TypeMayBeEmpty { get; }

        /// <summary>Draws it. A choice can be undone.</summary>
        public override void OnInspectorGUI()
        {
            serializedObject.Update();
            EditorGUILayout.PropertyField(_connection);
            DrawTopic();
            DrawType();
            DrawOthers("m_Script", "_connection", "_topic", "_type");
            serializedObject.ApplyModifiedProperties();
        }

        /// <summary>Draws the fields that are left, without those named.</summary>
        protected virtual void DrawOthers(params string[] drawn) => DrawPropertiesExcluding(serializedObject, drawn);

        /// <summary>Says what is wrong, unless it is null or empty.</summary>
        protected static void Warn(string warning)
        {
            if (!string.IsNullOrEmpty(warning))
            {
                EditorGUILayout.HelpBox(warning, MessageType.Warning);
            }
        }

        private void OnEnable()
        {
            if (target == null)
            {
                return; // after a reload Unity may ask for an inspector of nothing
            }
            _connection = serializedObject.FindProperty("_connection");
            _topic = serializedObject.FindProperty("_topic");
            _type = serializedObject.FindProperty("_type");
        }

        // also called before a domain reload
        private void OnDisable()
        {
            if (_graph != null)
            {
                EditorApplication.update -= _graph.Pump;
                _graph.Dispose();
                _graph = null;
            }
        }

        private void DrawTopic()
        {
            EditorGUILayout.BeginHorizontal();
            EditorGUILayout.PropertyField(_topic);
            GUILayoutOption width = GUILayout.Width(ButtonWidth);
            bool isOpened = _graph == null
                ? GUILayout.Button(new GUIContent("Connect", "Lists the topics that there are"), width)
                : EditorGUILayout.DropdownButton(new GUIContent("Topics"), FocusType.Keyboard, width);
            EditorGUILayout.EndHorizontal();
            if (isOpened && _graph == null)
            {
                Connect();
            }
            else if (isOpened)
            {
                ShowTopics();
            }
            Warn(TopicCheck.OfTopic(_topic.stringValue));
            if (_graph != null)
            {
                Tell(_graph.Problem);
                string carried = _graph.TypeOf(_topic.stringValue);
                Warn(TopicCheck.OfGraph(_topic.stringValue, _type.stringValue, carried));
            }
            if (Connection() == null)
            {
                Warn("no Gateway Connection in the scene: add one with GameObject > ROS 2 Gateway > Connection");
            }
        }

        private void DrawType()
        {
            EditorGUILayout.PropertyField(_type);
            EditorGUILayout.BeginHorizontal();
            _search = EditorGUILayout.TextField("Find a type", _search);
            GUILayoutOption width = GUILayout.Width(ButtonWidth);
            if (EditorGUILayout.DropdownButton(new GUIContent("Types"), FocusType.Keyboard, width))
            {
                ShowTypes();
            }
            EditorGUILayout.EndHorizontal();
            Warn(TopicCheck.OfType(_type.stringValue, TypeMayBeEmpty));
        }

        private void Connect()
        {
            _graph = new GraphDropdown(EditorClient.OptionsOf(Connection()));
            _graph.Changed += Repaint;
            EditorApplication.update += _graph.Pump;
        }

        private void ShowTopics()
        {
            GenericMenu menu = new();
            if (_graph.Topics.Count == 0)
            {
                menu.AddDisabledItem(Flat(_graph.Problem));
            }
            foreach (string topic in _graph.Topics)
            {
                string type = _graph.TypeOf(topic);
                string label = topic + "  " + (type.Length == 0 ? "(several types)" : type);
                string chosen = topic;
                menu.AddItem(Flat(label), topic == _topic.stringValue, () => Choose(chosen, type));
            }
            menu.ShowAsContext();
        }

        private void ShowTypes()
        {
            GenericMenu menu = new();
            IList<string> found = _catalogue.Find(_search);
            bool isShort = _search.Length > 0 && found.Count <= MostFound;
            foreach (string type in found)
            {
                string chosen = type;
                GUIContent label = isShort
                    ? Flat(_catalogue.Label(type))
                    : new GUIContent(type.Replace("/msg/", "/")); // a submenu per package
                menu.AddItem(label, type == _type.stringValue, () => Choose(null, chosen));
            }
            if (found.Count == 0)
            {
                menu.AddDisabledItem(new GUIContent("no type is called " + _search));
            }
            menu.ShowAsContext();
        }

        private void Choose(string topic, string type)
        {
            serializedObject.Update();
            if (topic != null)
            {
                _topic.stringValue = topic;
            }
            if (type.Length > 0)
            {
                _type.stringValue = type;
            }
            serializedObject.ApplyModifiedProperties();
        }

        private GatewayConnection Connection()
        {
            GatewayConnection chosen = _connection.objectReferenceValue as GatewayConnection;
            return chosen != null ? chosen : FindAnyObjectByType<GatewayConnection>();
        }

        // A slash in it would make a submenu. This one only looks like it.
        private static GUIContent Flat(string label) => new GUIContent(label.Replace('/', '\u2215'));

        private static void Tell(string text)
        {
            if (!string.IsNullOrEmpty(text))
            {
                EditorGUILayout.HelpBox(text, MessageType.Info);
            }
        }
    }
}
