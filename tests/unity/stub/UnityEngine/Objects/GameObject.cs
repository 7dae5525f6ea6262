// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Linq;
using UnityEngine.Stage;

namespace UnityEngine
{
    public sealed class GameObject : Object
    {
        private readonly List<Component> _components = new List<Component>();
        private string _tag = "Untagged";
        private SceneManagement.Scene _scene;

        public GameObject()
            : this("New Game Object")
        {
        }

        public GameObject(string name)
            : this(name, new Type[0])
        {
        }

        public GameObject(string name, params Type[] components)
        {
            MainThread.Check("Internal_CreateGameObject");
            Rename(name);
            _scene = SceneManagement.SceneManager.GetActiveScene();
            activeSelf = true;
            transform = (Transform)Attach(
                components.Contains(typeof(RectTransform)) ? typeof(RectTransform) : typeof(Transform));
            foreach (Type type in components.Where(type => type != typeof(RectTransform)))
            {
                AddComponent(type);
            }
        }

        public Transform transform { get; private set; }

        public GameObject gameObject
        {
            get { return this; }
        }

        public SceneManagement.Scene scene
        {
            get
            {
                MainThread.Check("get_scene");
                return transform.root.gameObject._scene;
            }
        }

        public int layer { get; set; }

        public string tag
        {
            get { return _tag; }
            set { _tag = value; }
        }

        public bool activeSelf { get; private set; }

        public bool activeInHierarchy
        {
            get
            {
                Transform parent = transform == null ? null : transform.parent;
                return activeSelf && (parent == null || parent.gameObject.activeInHierarchy);
            }
        }

        internal IEnumerable<Component> Components
        {
            get { return _components; }
        }

        public static GameObject Find(string name)
        {
            MainThread.Check("Find");
            return Scene.Objects.OfType<GameObject>().FirstOrDefault(
                o => o.activeInHierarchy && o.NameOf() == name);
        }

        public static GameObject CreatePrimitive(PrimitiveType type)
        {
            var primitive = new GameObject(type.ToString(), typeof(MeshFilter), typeof(MeshRenderer));
            Component collider = primitive.AddComponent(Primitives.ColliderOf(type));
            if (type == PrimitiveType.Quad)
            {
                ((MeshCollider)collider).Size = new Vector3(1F, 1F, 0F);
            }
            return primitive;
        }

        public void SetActive(bool value)
        {
            MainThread.Check("SetActive");
            if (activeSelf == value)
            {
                return;
            }
            activeSelf = value;
            transform.ActivityChanged();
        }

        public T AddComponent<T>() where T : Component
        {
            return (T)AddComponent(typeof(T));
        }

        public Component AddComponent(Type componentType)
        {
            MainThread.Check("AddComponent");
            if (componentType.IsDefined(typeof(DisallowMultipleComponent), true)
                && GetComponent(componentType) != null)
            {
                Debug.LogWarning("Can't add '" + componentType.Name + "' to " + NameOf()
                    + ": it is there already");
                return null;
            }
            object[] requirements = componentType.GetCustomAttributes(typeof(RequireComponent), true);
            foreach (RequireComponent required in requirements)
            {
                foreach (Type type in new[] { required.m_Type0, required.m_Type1, required.m_Type2 })
                {
                    if (type != null && GetComponent(type) == null)
                    {
                        AddComponent(type);
                    }
                }
            }
            if (componentType == typeof(RectTransform))
            {
                return ReplaceTransform();
            }
            Component component = Attach(componentType);
            component.Added();
            component.ActivityChanged();
            return component;
        }

        public T GetComponent<T>()
        {
            foreach (Component component in _components)
            {
                if (component is T)
                {
                    return (T)(object)component;
                }
            }
            return default(T);
        }

        public Component GetComponent(Type type)
        {
            return _components.FirstOrDefault(type.IsInstanceOfType);
        }

        public bool TryGetComponent<T>(out T component)
        {
            component = GetComponent<T>();
            return component != null;
        }

        public T[] GetComponents<T>()
        {
            return _components.OfType<T>().ToArray();
        }

        public T GetComponentInChildren<T>()
        {
            return GetComponentInChildren<T>(false);
        }

        public T GetComponentInChildren<T>(bool includeInactive)
        {
            return GetComponentsInChildren<T>(includeInactive).FirstOrDefault();
        }

        public T[] GetComponentsInChildren<T>()
        {
            return GetComponentsInChildren<T>(false);
        }

        public T[] GetComponentsInChildren<T>(bool includeInactive)
        {
            return transform.Hierarchy().Where(t => includeInactive || t.gameObject.activeInHierarchy)
                .SelectMany(t => t.gameObject.GetComponents<T>()).ToArray();
        }

        public T GetComponentInParent<T>()
        {
            for (Transform t = transform; t != null; t = t.parent)
            {
                var found = t.gameObject.GetComponent<T>();
                if (found != null)
                {
                    return found;
                }
            }
            return default(T);
        }

        /// <summary>A new component, which does not run yet.</summary>
        internal Component Attach(Type type)
        {
            var component = (Component)Activator.CreateInstance(type, true);
            component.Attached(this);
            _components.Add(component);
            return component;
        }

        private RectTransform ReplaceTransform()
        {
            Transform old = transform;
            var rect = (RectTransform)Attach(typeof(RectTransform));
            rect.TakeOver(old);
            _components.Remove(old);
            transform = rect;
            return rect;
        }

        internal void MoveTo(SceneManagement.Scene scene)
        {
            _scene = scene;
        }

        internal void Detach(Component component)
        {
            _components.Remove(component);
        }

        internal void ActivityChangedExceptTransform()
        {
            foreach (Component component in _components.ToArray())
            {
                if (!(component is Transform))
                {
                    component.ActivityChanged();
                }
            }
        }

        internal override bool IsActive()
        {
            return activeInHierarchy;
        }

        internal override void Die()
        {
            foreach (Transform child in transform.Children.ToArray())
            {
                DestroyImmediate(child.gameObject);
            }
            foreach (Component component in Enumerable.Reverse(_components).ToArray())
            {
                component.Die();
            }
            base.Die();
        }
    }

    public enum PrimitiveType
    {
        Sphere = 0,
        Capsule = 1,
        Cylinder = 2,
        Cube = 3,
        Plane = 4,
        Quad = 5,
    }
}
