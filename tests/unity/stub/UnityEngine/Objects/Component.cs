// SPDX-License-Identifier: Apache-2.0
using System;
using UnityEngine.Stage;

namespace UnityEngine
{
    public class Component : Object
    {
        private GameObject _gameObject;

        public GameObject gameObject
        {
            get
            {
                MainThread.Check("get_gameObject");
                return _gameObject;
            }
        }

        public Transform transform
        {
            get
            {
                MainThread.Check("get_transform");
                return _gameObject.transform;
            }
        }

        public string tag
        {
            get { return _gameObject.tag; }
            set { _gameObject.tag = value; }
        }

        public void SendMessage(string methodName, object value)
        {
            MainThread.Check("SendMessage");
            foreach (MonoBehaviour receiver in GetComponents<MonoBehaviour>())
            {
                receiver.Messages.Send(methodName, value);
            }
        }

        internal GameObject Owner
        {
            get { return _gameObject; }
        }

        public T GetComponent<T>()
        {
            MainThread.Check("GetComponent");
            return _gameObject.GetComponent<T>();
        }

        public Component GetComponent(Type type)
        {
            MainThread.Check("GetComponent");
            return _gameObject.GetComponent(type);
        }

        public bool TryGetComponent<T>(out T component)
        {
            MainThread.Check("TryGetComponent");
            return _gameObject.TryGetComponent(out component);
        }

        public T[] GetComponents<T>()
        {
            return _gameObject.GetComponents<T>();
        }

        public T GetComponentInChildren<T>()
        {
            return _gameObject.GetComponentInChildren<T>();
        }

        public T GetComponentInChildren<T>(bool includeInactive)
        {
            return _gameObject.GetComponentInChildren<T>(includeInactive);
        }

        public T[] GetComponentsInChildren<T>()
        {
            return _gameObject.GetComponentsInChildren<T>();
        }

        public T[] GetComponentsInChildren<T>(bool includeInactive)
        {
            return _gameObject.GetComponentsInChildren<T>(includeInactive);
        }

        public T GetComponentInParent<T>()
        {
            return _gameObject.GetComponentInParent<T>();
        }

        internal void Attached(GameObject owner)
        {
            _gameObject = owner;
        }

        /// <summary>It has been added, with all that it requires.</summary>
        internal virtual void Added()
        {
        }

        /// <summary>It, or what it belongs to, was switched on or off.</summary>
        internal virtual void ActivityChanged()
        {
        }

        internal override string NameOf()
        {
            return _gameObject.NameOf();
        }

        internal override void Rename(string value)
        {
            _gameObject.Rename(value);
        }

        internal override bool IsActive()
        {
            return _gameObject.activeInHierarchy;
        }

        internal override void Die()
        {
            _gameObject.Detach(this);
            base.Die();
        }
    }

    public class Behaviour : Component
    {
        private bool _enabled = true;

        public bool enabled
        {
            get
            {
                MainThread.Check("get_enabled");
                return _enabled;
            }

            set
            {
                MainThread.Check("set_enabled");
                if (_enabled != value)
                {
                    _enabled = value;
                    ActivityChanged();
                }
            }
        }

        public bool isActiveAndEnabled
        {
            get
            {
                MainThread.Check("get_isActiveAndEnabled");
                return _enabled && !IsDestroyed && Owner.activeInHierarchy;
            }
        }
    }
}
