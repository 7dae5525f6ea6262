// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections;
using System.Collections.Generic;
using UnityEngine.Stage;

namespace UnityEngine
{
    public class MonoBehaviour : Behaviour
    {
        private bool _isAwake;
        private bool _isOn;

        internal Messages Messages { get; private set; }

        internal bool IsStarted { get; set; }

        internal int ExecutionOrder { get; private set; }

        public Coroutine StartCoroutine(IEnumerator routine)
        {
            MainThread.Check("StartCoroutine");
            var coroutine = new Coroutine(this, routine);
            PlayerLoop.Add(coroutine);
            return coroutine;
        }

        public void StopCoroutine(Coroutine routine)
        {
            PlayerLoop.Remove(coroutine => coroutine == routine);
        }

        public void StopCoroutine(IEnumerator routine)
        {
            PlayerLoop.Remove(coroutine => coroutine.Is(routine));
        }

        public void StopAllCoroutines()
        {
            PlayerLoop.Remove(coroutine => coroutine.BelongsTo(this));
        }

        public static void print(object message)
        {
            Debug.Log(message);
        }

        internal override void Added()
        {
            Messages = new Messages(this);
            object[] orders = GetType().GetCustomAttributes(typeof(DefaultExecutionOrder), true);
            foreach (DefaultExecutionOrder order in orders)
            {
                ExecutionOrder = order.order;
            }
            Scene.Add(this);
        }

        internal override void ActivityChanged()
        {
            if (Messages == null)
            {
                return;
            }
            if (!_isAwake && Owner.activeInHierarchy)
            {
                _isAwake = true;
                Messages.Send(Messages.Awake);
            }
            bool isOn = _isAwake && isActiveAndEnabled;
            if (isOn != _isOn)
            {
                _isOn = isOn;
                Messages.Send(isOn ? Messages.OnEnable : Messages.OnDisable);
            }
            if (_isAwake && !IsDestroyed && !Owner.activeInHierarchy)
            {
                StopAllCoroutines();  // they survive being disabled, not being inactive
            }
        }

        /// <summary>Scripts are about to be reloaded.</summary>
        internal void BeginReload()
        {
            if (_isOn)
            {
                _isOn = false;
                Messages.Send(Messages.OnDisable);
            }
            StopAllCoroutines();
        }

        /// <summary>The end of a Play that is followed by another without a new scene.</summary>
        internal void EndPlay()
        {
            if (_isOn)
            {
                _isOn = false;
                Messages.Send(Messages.OnDisable);
            }
            if (_isAwake)
            {
                _isAwake = false;
                Messages.Send(Messages.OnDestroy);
            }
            StopAllCoroutines();
            IsStarted = false;
        }

        internal override void Die()
        {
            if (_isOn)
            {
                _isOn = false;
                Messages.Send(Messages.OnDisable);
            }
            if (_isAwake)
            {
                Messages.Send(Messages.OnDestroy);
            }
            StopAllCoroutines();
            Scene.Behaviours.Remove(this);
            base.Die();
        }
    }
}
