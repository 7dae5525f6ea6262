// SPDX-License-Identifier: Apache-2.0
using System;
using System.Reflection;

namespace UnityEngine
{
    public class ScriptableObject : Object
    {
        public static T CreateInstance<T>() where T : ScriptableObject
        {
            return (T)CreateInstance(typeof(T));
        }

        public static ScriptableObject CreateInstance(Type type)
        {
            return Create(type, instance => { });
        }

        /// <summary>With something to be done before it awakes.</summary>
        internal static ScriptableObject Create(Type type, Action<ScriptableObject> prepare)
        {
            var instance = (ScriptableObject)Activator.CreateInstance(type, true);
            prepare(instance);
            Send(instance, "Awake");
            Send(instance, "OnEnable");
            return instance;
        }

        internal override void Die()
        {
            Send(this, "OnDisable");
            Send(this, "OnDestroy");
            base.Die();
        }

        private static void Send(ScriptableObject target, string message)
        {
            const BindingFlags Declared = BindingFlags.Instance | BindingFlags.Public
                | BindingFlags.NonPublic | BindingFlags.DeclaredOnly;
            // private ones of base classes as well, as Unity does
            for (Type type = target.GetType(); type != typeof(ScriptableObject); type = type.BaseType)
            {
                MethodInfo method = type.GetMethod(message, Declared, null, Type.EmptyTypes, null);
                if (method != null)
                {
                    method.Invoke(target, null);
                    return;
                }
            }
        }
    }
}
