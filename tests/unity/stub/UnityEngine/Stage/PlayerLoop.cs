// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections;
using System.Collections.Generic;
using System.Diagnostics;
using System.Reflection;
using System.Threading;

namespace UnityEngine.Stage
{
    /// <summary>Unity's player loop without a screen. Not of Unity: tests that are to run there as well, are
    /// written as [UnityTest] and yield instead of calling it.</summary>
    public static class PlayerLoop
    {
        private const BindingFlags Initializers =
            BindingFlags.Static | BindingFlags.Public | BindingFlags.NonPublic | BindingFlags.DeclaredOnly;
        private const int FrameMs = 4;  // 250 frames per second: quick tests, and time for other threads
        private static readonly List<Coroutine> Coroutines = new List<Coroutine>();
        private static FrameSynchronizationContext _context;
        private static float _untilFixedUpdate;

        /// <summary>Makes the calling thread the main thread.</summary>
        public static void Start()
        {
            MainThread.Adopt();
            _context = new FrameSynchronizationContext();
            SynchronizationContext.SetSynchronizationContext(_context);
        }

        /// <summary>One frame that takes the given time, in seconds, without waiting for it.</summary>
        public static void Step(float deltaTime = 0.02f)
        {
            MainThread.Check("Step");
            Time.Advance(deltaTime);
            StartNew();
            UnityEngine.Rendering.AsyncGPUReadback.Complete();
            _untilFixedUpdate -= Time.deltaTime;
            while (_untilFixedUpdate <= 0)
            {
                _untilFixedUpdate += Time.fixedDeltaTime;
                Time.AdvanceFixed();
                ForEach(behaviour => behaviour.Messages.FixedUpdate);
                Resume(Phase.FixedUpdate);
            }
            ForEach(behaviour => behaviour.Messages.Update);
            _context.RunPosted();
            Resume(Phase.Update);
            ForEach(behaviour => behaviour.Messages.LateUpdate);
            Application.SendBeforeRender();
            Resume(Phase.EndOfFrame);
            ForEach(behaviour => behaviour.Messages.OnGUI);
            Input.EndFrame();
            Scene.DestroyDoomed(Time.time);
        }

        /// <summary>Runs a [UnityTest], a frame for every null that it yields, in real time unless
        /// Time.captureDeltaTime says otherwise.</summary>
        public static void Run(IEnumerator frames)
        {
            var test = new Coroutine(null, frames) { Throws = true };
            var clock = Stopwatch.StartNew();
            test.Resume(Phase.Update);
            while (!test.IsDone)
            {
                Thread.Sleep(FrameMs);
                float elapsed = (float)clock.Elapsed.TotalSeconds;
                clock.Restart();
                Step(Time.captureDeltaTime > 0 ? Time.captureDeltaTime
                    : Math.Min(elapsed, Time.maximumDeltaTime));
                test.Resume(Phase.FixedUpdate);
                test.Resume(Phase.Update);
                test.Resume(Phase.EndOfFrame);
            }
        }

        /// <summary>The window gets or loses the focus.</summary>
        public static void SetFocus(bool focused)
        {
            Application.SetFocused(focused);
            for (int i = 0; i < Scene.Behaviours.Count; i++)
            {
                MonoBehaviour behaviour = Scene.Behaviours[i];
                if (behaviour.isActiveAndEnabled)
                {
                    behaviour.Messages.Send(behaviour.Messages.OnApplicationFocus, focused);
                }
            }
        }

        /// <summary>The application is paused, as when the headset is taken off, or goes on.</summary>
        public static void SetPaused(bool paused)
        {
            for (int i = 0; i < Scene.Behaviours.Count; i++)
            {
                MonoBehaviour behaviour = Scene.Behaviours[i];
                if (behaviour.isActiveAndEnabled)
                {
                    behaviour.Messages.Send(behaviour.Messages.OnApplicationPause, paused);
                }
            }
        }

        /// <summary>Leaves play mode: OnApplicationQuit, OnDisable, OnDestroy, and nothing is left.</summary>
        public static void Quit()
        {
            Application.SendQuitting();
            ForEach(behaviour => behaviour.Messages.OnApplicationQuit);
            foreach (Object target in Scene.Objects.ToArray())
            {
                var root = target as GameObject;
                if (root != null && root.transform.parent == null)
                {
                    Object.DestroyImmediate(root);
                }
            }
        }

        /// <summary>Calls what is to be called when Play begins, before any scene is loaded.</summary>
        public static void BeginPlay()
        {
            foreach (Assembly assembly in AppDomain.CurrentDomain.GetAssemblies())
            {
                if (!assembly.FullName.StartsWith("Ros2Gateway", StringComparison.Ordinal))
                {
                    continue;
                }
                foreach (Type type in assembly.GetTypes())
                {
                    foreach (MethodInfo method in type.GetMethods(Initializers))
                    {
                        if (method.IsDefined(typeof(RuntimeInitializeOnLoadMethodAttribute), false))
                        {
                            method.Invoke(null, null);
                        }
                    }
                }
            }
        }

        /// <summary>Leaves play mode and enters it again where the editor reloads neither scripts nor scene: objects
        /// and static state stay as they are.</summary>
        public static void PlayAgain()
        {
            Application.SendQuitting();
            ForEach(behaviour => behaviour.Messages.OnApplicationQuit);
            MonoBehaviour[] all = Scene.Behaviours.ToArray();
            foreach (MonoBehaviour behaviour in all)
            {
                behaviour.EndPlay();
            }
            BeginPlay();
            foreach (MonoBehaviour behaviour in all)
            {
                behaviour.ActivityChanged();
            }
        }

        /// <summary>Reloads scripts in Play, as the editor does by default when they were compiled again: OnDisable, then
        /// OnEnable, without Awake and Start, with what Unity can serialize. Static state and coroutines are gone.</summary>
        public static void ReloadScripts()
        {
            MonoBehaviour[] all = Scene.Behaviours.ToArray();
            foreach (MonoBehaviour behaviour in all)
            {
                behaviour.BeginReload();
            }
            BeginPlay(); // clears static state
            foreach (MonoBehaviour behaviour in all)
            {
                ScriptReload.Forget(behaviour);
            }
            foreach (MonoBehaviour behaviour in all)
            {
                behaviour.ActivityChanged();
            }
        }

        internal static void Add(Coroutine coroutine)
        {
            Coroutines.Add(coroutine);
            coroutine.Resume(Phase.Update);
        }

        internal static void Remove(Predicate<Coroutine> which)
        {
            foreach (Coroutine coroutine in Coroutines.FindAll(which))
            {
                coroutine.Stop();
            }
            Coroutines.RemoveAll(coroutine => coroutine.IsDone);
        }

        private static void StartNew()
        {
            for (int i = 0; i < Scene.Behaviours.Count; i++)
            {
                MonoBehaviour behaviour = Scene.Behaviours[i];
                if (!behaviour.IsStarted && behaviour.isActiveAndEnabled)
                {
                    behaviour.IsStarted = true;
                    behaviour.Messages.Send(behaviour.Messages.Start);
                }
            }
        }

        // allocates nothing, so that a test can measure what a component allocates
        private static void ForEach(Func<MonoBehaviour, Action> message)
        {
            for (int i = 0; i < Scene.Behaviours.Count; i++)
            {
                MonoBehaviour behaviour = Scene.Behaviours[i];
                if (behaviour.IsStarted && behaviour.isActiveAndEnabled)
                {
                    behaviour.Messages.Send(message(behaviour));
                }
            }
        }

        private static void Resume(Phase phase)
        {
            int count = Coroutines.Count;
            for (int i = 0; i < count && i < Coroutines.Count; i++)
            {
                Coroutines[i].Resume(phase);
            }
            Coroutines.RemoveAll(coroutine => coroutine.IsDone);
        }
    }
}
