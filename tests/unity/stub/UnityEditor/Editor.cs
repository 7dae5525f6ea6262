// SPDX-License-Identifier: Apache-2.0
using System;
using UnityEngine;
using Object = UnityEngine.Object;

namespace UnityEditor
{
    public sealed class CustomEditor : Attribute
    {
        public CustomEditor(Type inspectedType)
            : this(inspectedType, false)
        {
        }

        public CustomEditor(Type inspectedType, bool editorForChildClasses)
        {
        }
    }

    [AttributeUsage(AttributeTargets.Class)]
    public sealed class CanEditMultipleObjects : Attribute
    {
    }

    public class Editor : ScriptableObject
    {
        private SerializedObject _serializedObject;

        public Object target { get; set; }

        public Object[] targets
        {
            get { return new[] { target }; }
        }

        public SerializedObject serializedObject
        {
            get { return _serializedObject ?? (_serializedObject = new SerializedObject(target)); }
        }

        public static Editor CreateEditor(Object targetObject, Type editorType)
        {
            return (Editor)Create(editorType, editor => ((Editor)editor).target = targetObject);
        }

        public virtual void OnInspectorGUI()
        {
            DrawDefaultInspector();
        }

        public bool DrawDefaultInspector()
        {
            return false;
        }

        protected static void DrawPropertiesExcluding(SerializedObject obj, params string[] propertyToExclude)
        {
        }

        public virtual bool RequiresConstantRepaint()
        {
            return false;
        }

        public void Repaint()
        {
        }
    }

    [AttributeUsage(AttributeTargets.Class, AllowMultiple = true)]
    public sealed class CustomPropertyDrawer : Attribute
    {
        public CustomPropertyDrawer(Type type)
        {
        }
    }

    public abstract class GUIDrawer
    {
    }

    public abstract class PropertyDrawer : GUIDrawer
    {
        public PropertyAttribute attribute { get; internal set; }

        public virtual void OnGUI(Rect position, SerializedProperty property, GUIContent label)
        {
        }

        public virtual float GetPropertyHeight(SerializedProperty property, GUIContent label)
        {
            return EditorGUIUtility.singleLineHeight;
        }
    }

    [AttributeUsage(AttributeTargets.Method, AllowMultiple = true)]
    public sealed class MenuItem : Attribute
    {
        public MenuItem(string itemName)
        {
        }

        public MenuItem(string itemName, bool isValidateFunction, int priority)
        {
        }
    }

    public enum MessageType
    {
        None = 0,
        Info = 1,
        Warning = 2,
        Error = 3,
    }
}
