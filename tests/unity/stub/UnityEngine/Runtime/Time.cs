// SPDX-License-Identifier: Apache-2.0
using System.Diagnostics;
using UnityEngine.Stage;

namespace UnityEngine
{
    public class Time
    {
        private static readonly Stopwatch Clock = Stopwatch.StartNew();
        private static float _timeScale = 1F;
        private static float _fixedDeltaTime = 0.02F;
        private static float _maximumDeltaTime = 0.3333333F;
        private static double _time;
        private static double _unscaledTime;
        private static float _deltaTime;
        private static float _unscaledDeltaTime;
        private static float _captureDeltaTime;
        private static double _fixedTime;
        private static int _frameCount;

        public static float time
        {
            get { return (float)timeAsDouble; }
        }

        public static double timeAsDouble
        {
            get
            {
                MainThread.Check("get_time");
                return _time;
            }
        }

        public static float deltaTime
        {
            get
            {
                MainThread.Check("get_deltaTime");
                return _deltaTime;
            }
        }

        public static float unscaledTime
        {
            get { return (float)unscaledTimeAsDouble; }
        }

        public static double unscaledTimeAsDouble
        {
            get
            {
                MainThread.Check("get_unscaledTime");
                return _unscaledTime;
            }
        }

        public static float unscaledDeltaTime
        {
            get
            {
                MainThread.Check("get_unscaledDeltaTime");
                return _unscaledDeltaTime;
            }
        }

        public static float fixedTime
        {
            get { return (float)_fixedTime; }
        }

        public static float fixedDeltaTime
        {
            get { return _fixedDeltaTime; }
            set { _fixedDeltaTime = value; }
        }

        public static float maximumDeltaTime
        {
            get { return _maximumDeltaTime; }
            set { _maximumDeltaTime = value; }
        }

        public static float captureDeltaTime
        {
            get { return _captureDeltaTime; }
            set { _captureDeltaTime = value; }
        }

        public static float timeScale
        {
            get { return _timeScale; }
            set { _timeScale = value; }
        }

        public static int frameCount
        {
            get
            {
                MainThread.Check("get_frameCount");
                return _frameCount;
            }
        }

        public static float realtimeSinceStartup
        {
            get { return (float)realtimeSinceStartupAsDouble; }
        }

        public static double realtimeSinceStartupAsDouble
        {
            get
            {
                MainThread.Check("get_realtimeSinceStartup");
                return Clock.Elapsed.TotalSeconds;
            }
        }

        internal static void Advance(float elapsed)
        {
            _frameCount++;
            _unscaledDeltaTime = elapsed;
            _unscaledTime += elapsed;
            _deltaTime = elapsed * _timeScale;
            _time += _deltaTime;
        }

        internal static void AdvanceFixed()
        {
            _fixedTime += _fixedDeltaTime;
        }
    }
}
