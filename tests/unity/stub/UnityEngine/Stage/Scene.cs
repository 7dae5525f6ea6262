// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;

namespace UnityEngine.Stage
{
    /// <summary>Everything that lives: all objects, and the behaviours in the order of their
    /// execution.</summary>
    internal static class Scene
    {
        public static readonly List<Object> Objects = new List<Object>();
        public static readonly List<MonoBehaviour> Behaviours = new List<MonoBehaviour>();
        private static readonly List<KeyValuePair<Object, float>> Doomed =
            new List<KeyValuePair<Object, float>>();
        private static int _lastId;

        public static int NextId()
        {
            return ++_lastId;
        }

        public static void Add(MonoBehaviour behaviour)
        {
            int index = Behaviours.Count;
            while (index > 0 && Behaviours[index - 1].ExecutionOrder > behaviour.ExecutionOrder)
            {
                index--;
            }
            Behaviours.Insert(index, behaviour);
        }

        public static void DestroyLater(Object target, float time)
        {
            Doomed.Add(new KeyValuePair<Object, float>(target, time));
        }

        public static void DestroyDoomed(float time)
        {
            for (int i = 0; i < Doomed.Count; i++)
            {
                if (Doomed[i].Value <= time)
                {
                    Object target = Doomed[i].Key;
                    Doomed.RemoveAt(i--);
                    Object.DestroyImmediate(target);
                }
            }
        }
    }
}
