// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections;
using System.Collections.Generic;
using UnityEngine.Stage;

namespace UnityEngine
{
    public class YieldInstruction
    {
    }

    public sealed class Coroutine : YieldInstruction
    {
        private readonly MonoBehaviour _owner;
        private readonly IEnumerator _routine;
        private readonly Stack<IEnumerator> _stack = new Stack<IEnumerator>();
        private object _awaited;
        private int _resumedIn;
        private float _until;

        internal Coroutine(MonoBehaviour owner, IEnumerator routine)
        {
            _owner = owner;
            _routine = routine;
            _stack.Push(routine);
            _resumedIn = -1;
        }

        internal bool IsDone
        {
            get { return _stack.Count == 0; }
        }

        internal bool Throws { get; set; }

        internal bool Is(IEnumerator routine)
        {
            return _routine == routine;
        }

        internal bool BelongsTo(MonoBehaviour owner)
        {
            return ReferenceEquals(_owner, owner);
        }

        internal void Stop()
        {
            _stack.Clear();
        }

        /// <summary>Goes on if this is the part of the frame it waits for.</summary>
        internal void Resume(Phase phase)
        {
            if (IsDone || !IsReady(phase))
            {
                return;
            }
            try
            {
                Advance();
            }
            catch (Exception exception)
            {
                _stack.Clear();
                if (Throws)
                {
                    throw;
                }
                Debug.LogException(exception, _owner);
            }
        }

        private void Advance()
        {
            _awaited = null;
            _resumedIn = Time.frameCount;
            while (_stack.Count > 0)
            {
                IEnumerator top = _stack.Peek();
                if (!top.MoveNext())
                {
                    if (_stack.Count > 0)
                    {
                        _stack.Pop();
                    }
                    continue;
                }
                _awaited = top.Current;
                var nested = _awaited as IEnumerator;
                if (nested == null)
                {
                    var wait = _awaited as WaitForSeconds;
                    _until = wait == null ? 0 : Time.time + wait.Seconds;
                    return;
                }
                _stack.Push(nested);
            }
        }

        private bool IsReady(Phase phase)
        {
            var coroutine = _awaited as Coroutine;
            if (coroutine != null)
            {
                return phase == Phase.Update && coroutine.IsDone;
            }
            if (_awaited is WaitForFixedUpdate)
            {
                return phase == Phase.FixedUpdate;
            }
            if (_awaited is WaitForEndOfFrame)
            {
                return phase == Phase.EndOfFrame;
            }
            bool isNextFrame = phase == Phase.Update && _resumedIn != Time.frameCount;
            return isNextFrame && (!(_awaited is WaitForSeconds) || Time.time >= _until);
        }
    }

    public sealed class WaitForSeconds : YieldInstruction
    {
        public WaitForSeconds(float seconds)
        {
            Seconds = seconds;
        }

        internal float Seconds { get; private set; }
    }

    public sealed class WaitForFixedUpdate : YieldInstruction
    {
    }

    public sealed class WaitForEndOfFrame : YieldInstruction
    {
    }

    public abstract class CustomYieldInstruction : IEnumerator
    {
        public abstract bool keepWaiting { get; }

        public object Current
        {
            get { return null; }
        }

        public bool MoveNext()
        {
            return keepWaiting;
        }

        public virtual void Reset()
        {
        }
    }

    public sealed class WaitUntil : CustomYieldInstruction
    {
        private readonly Func<bool> _predicate;

        public WaitUntil(Func<bool> predicate)
        {
            _predicate = predicate;
        }

        public override bool keepWaiting
        {
            get { return !_predicate(); }
        }
    }

    public sealed class WaitWhile : CustomYieldInstruction
    {
        private readonly Func<bool> _predicate;

        public WaitWhile(Func<bool> predicate)
        {
            _predicate = predicate;
        }

        public override bool keepWaiting
        {
            get { return _predicate(); }
        }
    }

    public class WaitForSecondsRealtime : CustomYieldInstruction
    {
        private float _until = -1;

        public WaitForSecondsRealtime(float time)
        {
            waitTime = time;
        }

        public float waitTime { get; set; }

        public override bool keepWaiting
        {
            get
            {
                if (_until < 0)
                {
                    _until = Time.realtimeSinceStartup + waitTime;
                }
                bool waits = Time.realtimeSinceStartup < _until;
                if (!waits)
                {
                    Reset();
                }
                return waits;
            }
        }

        public override void Reset()
        {
            _until = -1;
        }
    }
}
