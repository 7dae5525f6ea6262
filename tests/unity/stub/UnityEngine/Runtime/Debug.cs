// SPDX-License-Identifier: Apache-2.0
using System;
using System.Diagnostics;
using UnityEngine.Stage;

namespace UnityEngine
{
    /// <summary>Like Unity's, for all threads.</summary>
    public class Debug
    {
        public static bool isDebugBuild
        {
            get { return true; }
        }

        public static void Log(object message)
        {
            Take(LogType.Log, message, null);
        }

        public static void Log(object message, Object context)
        {
            Take(LogType.Log, message, null);
        }

        public static void LogFormat(string format, params object[] args)
        {
            Take(LogType.Log, string.Format(format, args), null);
        }

        public static void LogWarning(object message)
        {
            Take(LogType.Warning, message, null);
        }

        public static void LogWarning(object message, Object context)
        {
            Take(LogType.Warning, message, null);
        }

        public static void LogError(object message)
        {
            Take(LogType.Error, message, null);
        }

        public static void LogError(object message, Object context)
        {
            Take(LogType.Error, message, null);
        }

        public static void LogException(Exception exception)
        {
            LogException(exception, null);
        }

        public static void LogException(Exception exception, Object context)
        {
            string message = exception.GetType().Name + ": " + exception.Message;
            Take(LogType.Exception, message, exception.StackTrace);
        }

        [Conditional("UNITY_ASSERTIONS")]
        public static void Assert(bool condition)
        {
            if (!condition)
            {
                Take(LogType.Assert, "Assertion failed", null);
            }
        }

        [Conditional("UNITY_ASSERTIONS")]
        public static void Assert(bool condition, object message)
        {
            if (!condition)
            {
                Take(LogType.Assert, message, null);
            }
        }

        public static void DrawLine(Vector3 start, Vector3 end, Color color)
        {
        }

        public static void DrawRay(Vector3 start, Vector3 dir, Color color)
        {
        }

        private static void Take(LogType type, object message, string stackTrace)
        {
            string text = message == null ? "Null" : message.ToString();
            Console.WriteLine("[" + type + "] " + text + (stackTrace == null ? "" : "\n" + stackTrace));
            LogExpectations.Take(type, text);
            Application.SendLog(text, stackTrace ?? "", type);
        }
    }

    public enum LogType
    {
        Error = 0,
        Assert = 1,
        Warning = 2,
        Log = 3,
        Exception = 4,
    }
}
