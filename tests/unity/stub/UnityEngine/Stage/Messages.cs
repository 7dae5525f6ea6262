// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Reflection;

namespace UnityEngine.Stage
{
    /// <summary>The messages of one MonoBehaviour, found by their names as Unity finds them, private ones
    /// too.</summary>
    internal sealed class Messages
    {
        private const BindingFlags Declared =
            BindingFlags.Instance | BindingFlags.Public | BindingFlags.NonPublic | BindingFlags.DeclaredOnly;

        public readonly Action Awake;
        public readonly Action OnEnable;
        public readonly Action Start;
        public readonly Action FixedUpdate;
        public readonly Action Update;
        public readonly Action LateUpdate;
        public readonly Action OnDisable;
        public readonly Action OnDestroy;
        public readonly Action OnApplicationQuit;
        public readonly Action OnGUI;
        public readonly Action<bool> OnApplicationFocus;
        public readonly Action<bool> OnApplicationPause;
        private readonly MonoBehaviour _target;

        public Messages(MonoBehaviour target)
        {
            _target = target;
            Awake = Find<Action>("Awake");
            OnEnable = Find<Action>("OnEnable");
            Start = Find<Action>("Start") ?? Coroutine("Start");
            FixedUpdate = Find<Action>("FixedUpdate");
            Update = Find<Action>("Update");
            LateUpdate = Find<Action>("LateUpdate");
            OnDisable = Find<Action>("OnDisable");
            OnDestroy = Find<Action>("OnDestroy");
            OnApplicationQuit = Find<Action>("OnApplicationQuit");
            OnGUI = Find<Action>("OnGUI");
            OnApplicationFocus = Find<Action<bool>>("OnApplicationFocus");
            OnApplicationPause = Find<Action<bool>>("OnApplicationPause");
        }

        /// <summary>Calls one. An exception is logged and goes no further, as in Unity.</summary>
        public void Send(Action message)
        {
            if (message == null)
            {
                return;
            }
            try
            {
                message();
            }
            catch (Exception exception)
            {
                Debug.LogException(exception, _target);
            }
        }

        public void Send(Action<bool> message, bool value)
        {
            if (message == null)
            {
                return;
            }
            try
            {
                message(value);
            }
            catch (Exception exception)
            {
                Debug.LogException(exception, _target);
            }
        }

        /// <summary>Calls one by its name, if the behaviour has it, as Component.SendMessage does.</summary>
        public void Send(string name, object value)
        {
            MethodInfo method = Method(name, 1) ?? Method(name, 0);
            if (method != null)
            {
                object[] arguments = method.GetParameters().Length == 1 ? new[] { value } : null;
                Send(() => method.Invoke(_target, arguments));
            }
        }

        private T Find<T>(string name) where T : class
        {
            MethodInfo signature = typeof(T).GetMethod("Invoke");
            MethodInfo method = Method(name, signature.GetParameters().Length);
            bool fits = method != null && method.ReturnType == typeof(void);
            return fits ? (T)(object)Delegate.CreateDelegate(typeof(T), _target, method) : null;
        }

        private Action Coroutine(string name)
        {
            MethodInfo method = Method(name, 0);
            if (method == null || method.ReturnType != typeof(System.Collections.IEnumerator))
            {
                return null;
            }
            return () => _target.StartCoroutine((System.Collections.IEnumerator)method.Invoke(_target, null));
        }

        private MethodInfo Method(string name, int parameters)
        {
            for (Type type = _target.GetType(); type != typeof(MonoBehaviour); type = type.BaseType)
            {
                foreach (MethodInfo method in type.GetMethods(Declared))
                {
                    if (method.Name == name && method.GetParameters().Length == parameters)
                    {
                        return method;
                    }
                }
            }
            return null;
        }
    }
}
