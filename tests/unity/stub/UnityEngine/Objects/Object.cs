// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using UnityEngine.Stage;

namespace UnityEngine
{
    public class Object
    {
        private readonly int _id = Scene.NextId();
        private string _name = "";

        public Object()
        {
            lock (Scene.Objects)
            {
                Scene.Objects.Add(this);
            }
        }

        public HideFlags hideFlags { get; set; }

        public string name
        {
            get
            {
                MainThread.Check("GetName");
                return NameOf();
            }

            set
            {
                MainThread.Check("SetName");
                Rename(value);
            }
        }

        internal bool IsDestroyed { get; private set; }

        public override int GetHashCode()
        {
            return _id;
        }

        public override bool Equals(object other)
        {
            var target = other as Object;
            return ReferenceEquals(this, other) || (other == null || (object)target != null)
                && this == target;
        }

        public override string ToString()
        {
            return IsDestroyed ? "null" : NameOf() + " (" + GetType().FullName + ")";
        }

        public static implicit operator bool(Object exists)
        {
            return !IsNull(exists);
        }

        public static bool operator ==(Object x, Object y)
        {
            return IsNull(x) ? IsNull(y) : ReferenceEquals(x, y);
        }

        public static bool operator !=(Object x, Object y)
        {
            return !(x == y);
        }

        public static void Destroy(Object obj)
        {
            Destroy(obj, 0);
        }

        public static void Destroy(Object obj, float t)
        {
            MainThread.Check("Destroy");
            if (obj != null)
            {
                Scene.DestroyLater(obj, Time.time + t);
            }
        }

        public static void DestroyImmediate(Object obj)
        {
            MainThread.Check("DestroyImmediate");
            if (obj != null)
            {
                obj.Die();
            }
        }

        public static void DontDestroyOnLoad(Object target)
        {
            MainThread.Check("DontDestroyOnLoad");
            var component = target as Component;
            GameObject holder = component != null ? component.gameObject : target as GameObject;
            if (holder == null)
            {
                return;
            }
            if (holder.transform.parent != null)
            {
                Debug.LogWarning("DontDestroyOnLoad only works for root GameObjects or components on root GameObjects.");
                return;
            }
            holder.MoveTo(SceneManagement.SceneManager.Lasting);
        }

        public static T Instantiate<T>(T original) where T : Object
        {
            return Instantiate(original, null);
        }

        public static T Instantiate<T>(T original, Transform parent) where T : Object
        {
            return (T)Cloner.Clone(original, parent, null, null);
        }

        public static T Instantiate<T>(T original, Vector3 position, Quaternion rotation) where T : Object
        {
            return Instantiate(original, position, rotation, null);
        }

        public static T Instantiate<T>(T original, Vector3 position, Quaternion rotation, Transform parent)
            where T : Object
        {
            return (T)Cloner.Clone(original, parent, position, rotation);
        }

        public static T FindAnyObjectByType<T>() where T : Object
        {
            T[] found = All<T>();
            return found.Length == 0 ? null : found[0];
        }

        /// <summary>All that are active, for the stub's own parts. Unity's versions agree on no such member.</summary>
        internal static T[] All<T>() where T : Object
        {
            MainThread.Check("FindAnyObjectByType");
            var found = new List<T>();
            foreach (Object target in Scene.Objects)
            {
                var wanted = target as T;
                if (wanted != null && wanted.IsActive())
                {
                    found.Add(wanted);
                }
            }
            return found.ToArray();
        }

        internal virtual string NameOf()
        {
            return _name;
        }

        internal virtual void Rename(string value)
        {
            _name = value;
        }

        internal virtual bool IsActive()
        {
            return true;
        }

        /// <summary>Ends it. An overrider first ends its own parts.</summary>
        internal virtual void Die()
        {
            IsDestroyed = true;
            lock (Scene.Objects)
            {
                Scene.Objects.Remove(this);
            }
        }

        private static bool IsNull(Object target)
        {
            return (object)target == null || target.IsDestroyed;
        }
    }

    [Flags]
    public enum HideFlags
    {
        None = 0,
        HideInHierarchy = 1,
        HideInInspector = 2,
        DontSaveInEditor = 4,
        NotEditable = 8,
        DontSaveInBuild = 16,
        DontUnloadUnusedAsset = 32,
        DontSave = 52,
        HideAndDontSave = 61,
    }
}
