// SPDX-License-Identifier: Apache-2.0
using System;
using System.IO;
using UnityEngine.Events;
using UnityEngine.Stage;

namespace UnityEngine
{
    public class Application
    {
        private static bool _isFocused = true;

        public delegate void LogCallback(string condition, string stackTrace, LogType type);

        public static event LogCallback logMessageReceived;

        public static event LogCallback logMessageReceivedThreaded;

        public static event Action<bool> focusChanged;

        public static event Action quitting;

        public static event UnityAction onBeforeRender;

        public static bool isPlaying
        {
            get
            {
                MainThread.Check("get_isPlaying");
                return true;
            }
        }

        public static bool isFocused
        {
            get
            {
                MainThread.Check("get_isFocused");
                return _isFocused;
            }
        }

        public static bool isEditor
        {
            get { return false; }
        }

        public static bool isMobilePlatform
        {
            get { return false; }
        }

        public static bool runInBackground { get; set; }

        public static int targetFrameRate { get; set; }

        public static RuntimePlatform platform
        {
            get { return RuntimePlatform.LinuxPlayer; }
        }

        public static string persistentDataPath
        {
            get
            {
                MainThread.Check("get_persistentDataPath");
                return Path.GetTempPath();
            }
        }

        public static string productName
        {
            get { return "Stage"; }
        }

        public static string version
        {
            get { return "0.1"; }
        }

        public static string unityVersion
        {
            get { return "2021.3.18f1"; }
        }

        public static void Quit()
        {
            MainThread.Check("Quit");
        }

        internal static void SetFocused(bool focused)
        {
            _isFocused = focused;
            if (focusChanged != null)
            {
                focusChanged(focused);
            }
        }

        internal static void SendBeforeRender()
        {
            if (onBeforeRender != null)
            {
                onBeforeRender();
            }
        }

        internal static void SendQuitting()
        {
            if (quitting != null)
            {
                quitting();
            }
        }

        internal static void SendLog(string text, string stackTrace, LogType type)
        {
            if (logMessageReceivedThreaded != null)
            {
                logMessageReceivedThreaded(text, stackTrace, type);
            }
            if (logMessageReceived != null && MainThread.IsCurrent)
            {
                logMessageReceived(text, stackTrace, type);
            }
        }
    }

    public enum RuntimePlatform
    {
        OSXEditor = 0,
        OSXPlayer = 1,
        WindowsPlayer = 2,
        WindowsEditor = 7,
        IPhonePlayer = 8,
        Android = 11,
        LinuxPlayer = 13,
        LinuxEditor = 16,
        WebGLPlayer = 17,
    }
}
