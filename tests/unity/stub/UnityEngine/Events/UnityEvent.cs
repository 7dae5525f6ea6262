// SPDX-License-Identifier: Apache-2.0
namespace UnityEngine.Events
{
    public delegate void UnityAction();

    public delegate void UnityAction<T0>(T0 arg0);

    public delegate void UnityAction<T0, T1>(T0 arg0, T1 arg1);

    public abstract class UnityEventBase
    {
        public abstract void RemoveAllListeners();

        /// <summary>None: there is no Inspector.</summary>
        public int GetPersistentEventCount()
        {
            return 0;
        }
    }

    public class UnityEvent : UnityEventBase
    {
        private UnityAction _listeners;

        public void AddListener(UnityAction call)
        {
            _listeners += call;
        }

        public void RemoveListener(UnityAction call)
        {
            _listeners -= call;
        }

        public override void RemoveAllListeners()
        {
            _listeners = null;
        }

        public void Invoke()
        {
            if (_listeners != null)
            {
                _listeners();
            }
        }
    }

    public class UnityEvent<T0> : UnityEventBase
    {
        private UnityAction<T0> _listeners;

        public void AddListener(UnityAction<T0> call)
        {
            _listeners += call;
        }

        public void RemoveListener(UnityAction<T0> call)
        {
            _listeners -= call;
        }

        public override void RemoveAllListeners()
        {
            _listeners = null;
        }

        public void Invoke(T0 arg0)
        {
            if (_listeners != null)
            {
                _listeners(arg0);
            }
        }
    }

    public class UnityEvent<T0, T1> : UnityEventBase
    {
        private UnityAction<T0, T1> _listeners;

        public void AddListener(UnityAction<T0, T1> call)
        {
            _listeners += call;
        }

        public void RemoveListener(UnityAction<T0, T1> call)
        {
            _listeners -= call;
        }

        public override void RemoveAllListeners()
        {
            _listeners = null;
        }

        public void Invoke(T0 arg0, T1 arg1)
        {
            if (_listeners != null)
            {
                _listeners(arg0, arg1);
            }
        }
    }
}
