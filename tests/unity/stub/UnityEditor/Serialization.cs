// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Reflection;
using Object = UnityEngine.Object;

namespace UnityEditor
{
    /// <summary>An object's fields by name, read at once and written when the changes are applied.</summary>
    public class SerializedObject : IDisposable
    {
        private readonly Object _target;
        private readonly Dictionary<string, SerializedProperty> _properties =
            new Dictionary<string, SerializedProperty>();
        private readonly List<Action> _changes = new List<Action>();

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
            bool isChanged = _changes.Count > 0;
            foreach (Action change in _changes)
            {
                change();
            }
            _changes.Clear();
            return isChanged;
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

        internal void Change(Action change)
        {
            _changes.Add(change);
        }
    }

    public class SerializedProperty
    {
        private readonly object _owner;
        private readonly FieldInfo _field;
        private object _changed;
        private bool _isChanged;

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
            get { return (string)Value; }
            set { Value = value; }
        }

        public int intValue
        {
            get { return Convert.ToInt32(Value); }
            set { Value = value; }
        }

        public float floatValue
        {
            get { return Convert.ToSingle(Value); }
            set { Value = value; }
        }

        public bool boolValue
        {
            get { return (bool)Value; }
            set { Value = value; }
        }

        public int enumValueIndex
        {
            get { return Array.IndexOf(Enum.GetValues(_field.FieldType), Value); }
            set { Value = Enum.GetValues(_field.FieldType).GetValue(value); }
        }

        public object managedReferenceValue
        {
            get { return Value; }
            set { Value = value; }
        }

        public Object objectReferenceValue
        {
            get { return (Object)Value; }
            set { Value = value; }
        }

        private object Value
        {
            get
            {
                return _isChanged ? _changed : _field.GetValue(_owner);
            }

            set
            {
                _changed = value;
                _isChanged = true;
                serializedObject.Change(Apply);
            }
        }

        public SerializedProperty FindPropertyRelative(string relativePropertyPath)
        {
            return Of(serializedObject, Value, relativePropertyPath);
        }

        private void Apply()
        {
            if (_isChanged)
            {
                _field.SetValue(_owner, _changed);
                _isChanged = false;
                UnityEngine.Stage.Inspector.Applied.Add(propertyPath);
            }
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
