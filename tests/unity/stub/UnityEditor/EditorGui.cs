// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using UnityEngine;
using UnityEngine.Stage;
using Object = UnityEngine.Object;

namespace UnityEditor
{
    /// <summary>Draws nothing. Stage.Inspector clicks, types and reads.</summary>
    public sealed class EditorGUILayout
    {
        public static bool PropertyField(SerializedProperty property, params GUILayoutOption[] options)
        {
            return false;
        }

        public static bool PropertyField(SerializedProperty property, GUIContent label,
            params GUILayoutOption[] options)
        {
            return false;
        }

        public static void LabelField(string label, params GUILayoutOption[] options)
        {
        }

        public static void LabelField(string label, string label2, params GUILayoutOption[] options)
        {
        }

        public static string TextField(string label, string text, params GUILayoutOption[] options)
        {
            return Inspector.Field(label, text);
        }

        public static bool ToggleLeft(string label, bool value, params GUILayoutOption[] options)
        {
            Inspector.Toggles[label] = value;
            return Inspector.IsClicked(label) ? !value : value;
        }

        public static Object ObjectField(string label, Object obj, Type objType, bool allowSceneObjects,
            params GUILayoutOption[] options)
        {
            return obj;
        }

        public static int Popup(string label, int selectedIndex, string[] displayedOptions,
            params GUILayoutOption[] options)
        {
            return selectedIndex;
        }

        public static bool DropdownButton(GUIContent content, FocusType focusType,
            params GUILayoutOption[] options)
        {
            return Inspector.IsClicked(content.text);
        }

        public static void HelpBox(string message, MessageType type)
        {
            Inspector.Words.Add(message);
        }

        public static void Space()
        {
        }

        public static Vector2 BeginScrollView(Vector2 scrollPosition, params GUILayoutOption[] options)
        {
            return scrollPosition;
        }

        public static void EndScrollView()
        {
        }

        public static Rect BeginHorizontal(params GUILayoutOption[] options)
        {
            return new Rect();
        }

        public static void EndHorizontal()
        {
        }
    }

    public sealed class EditorGUI
    {
        public static int indentLevel { get; set; }

        public static GUIContent BeginProperty(Rect totalPosition, GUIContent label,
            SerializedProperty property)
        {
            return label;
        }

        public static void EndProperty()
        {
        }

        public static void BeginChangeCheck()
        {
        }

        public static bool EndChangeCheck()
        {
            return false;
        }

        public static bool PropertyField(Rect position, SerializedProperty property, GUIContent label)
        {
            return false;
        }

        public static int Popup(Rect position, int selectedIndex, string[] displayedOptions)
        {
            return selectedIndex;
        }

        public static string TextField(Rect position, GUIContent label, string text)
        {
            return text;
        }

        public static bool DropdownButton(Rect position, GUIContent content, FocusType focusType)
        {
            return false;
        }
    }

    public sealed class EditorGUIUtility : GUIUtility
    {
        public static float singleLineHeight
        {
            get { return 18F; }
        }

        public static float standardVerticalSpacing
        {
            get { return 2F; }
        }

        public static float labelWidth { get; set; }
    }

    public sealed class GenericMenu
    {
        private readonly List<KeyValuePair<string, Action>> _items = new List<KeyValuePair<string, Action>>();

        public delegate void MenuFunction();

        public delegate void MenuFunction2(object userData);

        public void AddItem(GUIContent content, bool on, MenuFunction func)
        {
            _items.Add(new KeyValuePair<string, Action>(content.text, () => func()));
        }

        public void AddItem(GUIContent content, bool on, MenuFunction2 func, object userData)
        {
        }

        public void AddDisabledItem(GUIContent content)
        {
            _items.Add(new KeyValuePair<string, Action>(content.text, null));
        }

        public void AddSeparator(string path)
        {
        }

        public void DropDown(Rect position)
        {
        }

        public void ShowAsContext()
        {
            Inspector.Menu.Clear();
            foreach (KeyValuePair<string, Action> item in _items)
            {
                Inspector.Menu[item.Key] = item.Value;
            }
        }
    }

    public sealed class Undo
    {
        public static void RegisterCreatedObjectUndo(Object objectToUndo, string name)
        {
        }
    }

    public sealed class Selection
    {
        public static Object activeObject { get; set; }

        public static GameObject activeGameObject { get; set; }
    }
}
