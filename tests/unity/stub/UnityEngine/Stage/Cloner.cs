// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Linq;
using System.Reflection;

namespace UnityEngine.Stage
{
    /// <summary>Object.Instantiate: copies what Unity serializes, and turns references into the original
    /// to ones into the copy.</summary>
    internal static class Cloner
    {
        private const BindingFlags Fields =
            BindingFlags.Instance | BindingFlags.Public | BindingFlags.NonPublic | BindingFlags.DeclaredOnly;

        public static Object Clone(Object original, Transform parent, Vector3? position, Quaternion? rotation)
        {
            MainThread.Check("Internal_CloneSingle");
            if (original == null)
            {
                throw new ArgumentException("The Object you want to instantiate is null.");
            }
            var component = original as Component;
            GameObject source = component != null ? component.gameObject : original as GameObject;
            var copies = new Dictionary<Object, Object>();
            if (source == null)
            {
                var copy = (Object)Activator.CreateInstance(original.GetType(), true);
                CopyFields(original, copy, copies);
                copy.Rename(original.NameOf() + "(Clone)");
                return copy;
            }
            GameObject root = Copy(source, copies);
            root.Rename(source.NameOf() + "(Clone)");
            root.transform.SetParent(parent, false);
            if (position.HasValue)
            {
                root.transform.SetPositionAndRotation(position.Value, rotation.Value);
            }
            foreach (KeyValuePair<Object, Object> pair in copies.ToArray())
            {
                if (!(pair.Key is GameObject) && !(pair.Key is Transform))
                {
                    CopyFields(pair.Key, pair.Value, copies);
                }
            }
            foreach (Component copy in copies.Values.OfType<Component>())
            {
                copy.Added();
            }
            foreach (Component copy in copies.Values.OfType<Component>())
            {
                copy.ActivityChanged();
            }
            return copies[original];
        }

        private static GameObject Copy(GameObject source, Dictionary<Object, Object> copies)
        {
            var copy = source.transform is RectTransform
                ? new GameObject(source.NameOf(), typeof(RectTransform))
                : new GameObject(source.NameOf());
            copy.SetActive(source.activeSelf);
            copy.layer = source.layer;
            copy.tag = source.tag;
            copies[source] = copy;
            copies[source.transform] = copy.transform;
            copy.transform.localPosition = source.transform.localPosition;
            copy.transform.localRotation = source.transform.localRotation;
            copy.transform.localScale = source.transform.localScale;
            foreach (Component component in source.Components.Where(c => !(c is Transform)))
            {
                copies[component] = copy.Attach(component.GetType());
            }
            foreach (Transform child in source.transform.Children)
            {
                Copy(child.gameObject, copies).transform.SetParent(copy.transform, false);
            }
            return copy;
        }

        private static void CopyFields(Object source, Object copy, Dictionary<Object, Object> copies)
        {
            Type type = source.GetType();
            for (; type != typeof(Component) && type != typeof(Object); type = type.BaseType)
            {
                bool isOurs = type.Assembly == typeof(Cloner).Assembly;
                if (type == typeof(MonoBehaviour))
                {
                    continue;
                }
                foreach (FieldInfo field in type.GetFields(Fields))
                {
                    bool isSerialized = field.IsPublic || isOurs
                        || field.IsDefined(typeof(SerializeField), false);
                    if (isSerialized && !field.IsInitOnly
                        && !field.IsDefined(typeof(NonSerializedAttribute), false))
                    {
                        object value = field.GetValue(source);
                        var reference = value as Object;
                        Object mapped;
                        bool isInside = (object)reference != null
                            && copies.TryGetValue(reference, out mapped);
                        field.SetValue(copy, isInside ? copies[reference] : value);
                    }
                }
            }
        }
    }
}
