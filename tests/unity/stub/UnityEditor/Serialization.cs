// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Reflection;
using Object = UnityEngine.Object;

namespace UnityEditor
{
    /// <summary>An object's fields by name, read and written at once.</summary>
    public class SerializedObject : IDisposable
    {
        private readonly Object _target;
        private readonly Dictionary<string, SerializedProperty> _properties =
            new Dictionary<string, SerializedProperty>();

        public SerializedObject(Object obj)
        {
            _target = obj;
        }

        public Object targetObject
        {
            get { return _target; }
        }

        public bool isEditingMultipleObjects
        {
            get { return false; }
        }

        public void Update()
        {
        }

        public bool ApplyModifiedProperties()
        {
            return true;
        }

        public SerializedProperty FindProperty(string propertyPath)
        {
            SerializedProperty property;
            if (!_properties.TryGetValue(propertyPath, out property))
            {
                property = SerializedProperty.Of(this, _target, propertyPath);
                _properties[propertyPath] = property;
            }
            return property;
        }

        public void Dispose()
        {
        }
    }

    public class SerializedProperty
    {
        private readonly object _owner;
        private readonly FieldInfo _field;

        private SerializedProperty(SerializedObject root, object owner, FieldInfo field, string path)
        {
            serializedObject = root;
            _owner = owner;
            _field = field;
            propertyPath = path;
        }

        public SerializedObject serializedObject { get; private set; }

        public string propertyPath { get; private set; }

        public string name
        {
            get { return _field.Name; }
        }

        public string displayName
        {
            get { return ObjectNames.NicifyVariableName(_field.Name); }
        }

        public string stringValue
        {
            get { return (string)_field.GetValue(_owner); }
            set { _field.SetValue(_owner, value); }
        }

        public int intValue
        {
            get { return Convert.ToInt32(_field.GetValue(_owner)); }
            set { _field.SetValue(_owner, value); }
        }

        public float floatValue
        {
            get { return Convert.ToSingle(_field.GetValue(_owner)); }
            set { _field.SetValue(_owner, value); }
        }

        public bool boolValue
        {
            get { return (bool)_field.GetValue(_owner); }
            set { _field.SetValue(_owner, value); }
        }

        public int enumValueIndex
        {
            get { return Array.IndexOf(Enum.GetValues(_field.FieldType), _field.GetValue(_owner)); }
            set { _field.SetValue(_owner, Enum.GetValues(_field.FieldType).GetValue(value)); }
        }

        public object managedReferenceValue
        {
            get { return _field.GetValue(_owner); }
            set { _field.SetValue(_owner, value); }
        }

        public Object objectReferenceValue
        {
            get { return (Object)_field.GetValue(_owner); }
            set { _field.SetValue(_owner, value); }
        }

        public SerializedProperty FindPropertyRelative(string relativePropertyPath)
        {
            return Of(serializedObject, _field.GetValue(_owner), relativePropertyPath);
        }

        internal static SerializedProperty Of(SerializedObject root, object owner, string path)
        {
            for (Type type = owner.GetType(); type != null; type = type.BaseType)
            {
                FieldInfo field = type.GetField(
                    path, BindingFlags.Instance | BindingFlags.Public | BindingFlags.NonPublic);
                if (field != null)
                {
                    return new SerializedProperty(root, owner, field, path);
                }
            }
            return null;
        }
    }

    public sealed class ObjectNames
    {
        public static string NicifyVariableName(string name)
        {
            string bare = name.TrimStart('_');
            return bare.Substring(0, 1).ToUpperInvariant() + bare.Substring(1);
        }
    }
}
