// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Reflection;

namespace UnityEngine.Stage
{
    /// <summary>The fields that a component keeps when the editor reloads scripts in Play: those that Unity can serialize, private
    /// fields as well. Null becomes an empty text, list or object. All else is as the constructor makes it.</summary>
    internal static class ScriptReload
    {
        private const BindingFlags Declared =
            BindingFlags.Instance | BindingFlags.Public | BindingFlags.NonPublic | BindingFlags.DeclaredOnly;

        public static void Forget(MonoBehaviour behaviour)
        {
            var kept = new List<KeyValuePair<FieldInfo, object>>();
            foreach (FieldInfo field in Fields(behaviour.GetType()))
            {
                object value = field.GetValue(behaviour);
                if (field.DeclaringType.Assembly == typeof(ScriptReload).Assembly)
                {
                    kept.Add(new KeyValuePair<FieldInfo, object>(field, value)); // of the engine itself
                }
                else if (Survives(field))
                {
                    kept.Add(new KeyValuePair<FieldInfo, object>(field, Again(field.FieldType, value)));
                }
                else
                {
                    field.SetValue(behaviour, null); // the default of a struct
                }
            }
            ConstructorInfo constructor = behaviour.GetType().GetConstructor(Type.EmptyTypes);
            constructor.Invoke(behaviour, null); // on the object that is there
            foreach (KeyValuePair<FieldInfo, object> pair in kept)
            {
                pair.Key.SetValue(behaviour, pair.Value);
            }
            Scene.Objects.RemoveAt(Scene.Objects.Count - 1); // the constructor added it once more
        }

        private static IEnumerable<FieldInfo> Fields(Type type)
        {
            for (; type != null; type = type.BaseType)
            {
                foreach (FieldInfo field in type.GetFields(Declared))
                {
                    yield return field;
                }
            }
        }

        private static bool Survives(FieldInfo field)
        {
            return !field.IsInitOnly && !field.IsDefined(typeof(NonSerializedAttribute), false)
                && (field.IsDefined(typeof(SerializeReference), false) || Survives(field.FieldType));
        }

        private static bool Survives(Type type)
        {
            if (type.IsPrimitive || type.IsEnum || type == typeof(string) || typeof(Object).IsAssignableFrom(type))
            {
                return true;
            }
            if (type.IsArray)
            {
                return !type.GetElementType().IsArray && Survives(type.GetElementType());
            }
            if (type.IsGenericType)
            {
                return type.GetGenericTypeDefinition() == typeof(List<>) && Survives(type.GetGenericArguments()[0]);
            }
            bool isMade = !type.IsAbstract && !type.IsInterface && !typeof(Delegate).IsAssignableFrom(type);
            bool isOfEngine = type.Assembly == typeof(ScriptReload).Assembly;
            bool isOfRuntime = type.Assembly == typeof(object).Assembly;
            return isMade && (isOfEngine ? type.IsValueType || type.IsSerializable : type.IsSerializable && !isOfRuntime);
        }

        private static object Again(Type type, object value)
        {
            bool isPlain = type.IsValueType || typeof(Object).IsAssignableFrom(type) || type.IsInterface;
            if (isPlain || (value != null && (type == typeof(string) || type.IsArray || type.IsGenericType)))
            {
                return value;
            }
            if (value == null)
            {
                return type == typeof(string) ? ""
                    : type.IsArray ? Array.CreateInstance(type.GetElementType(), 0) : Activator.CreateInstance(type);
            }
            if (type.Assembly == typeof(ScriptReload).Assembly)
            {
                return value;
            }
            object again = Activator.CreateInstance(type);
            foreach (FieldInfo field in Fields(type))
            {
                if (Survives(field))
                {
                    field.SetValue(again, Again(field.FieldType, field.GetValue(value)));
                }
            }
            return again;
        }
    }
}
