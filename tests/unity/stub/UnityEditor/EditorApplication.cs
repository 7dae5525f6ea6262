// SPDX-License-Identifier: Apache-2.0
using System;
using Object = UnityEngine.Object;

namespace UnityEditor
{
    public sealed class EditorApplication
    {
        public static CallbackFunction update;
        public static CallbackFunction delayCall;

        public delegate void CallbackFunction();

        public static event Action<PlayModeStateChange> playModeStateChanged;

        public static bool isPlaying { get; set; }

        public static bool isPlayingOrWillChangePlaymode
        {
            get { return isPlaying; }
        }

        public static double timeSinceStartup
        {
            get { return UnityEngine.Time.realtimeSinceStartupAsDouble; }
        }

        internal static void Change(PlayModeStateChange state)
        {
            if (playModeStateChanged != null)
            {
                playModeStateChanged(state);
            }
        }
    }

    public enum PlayModeStateChange
    {
        EnteredEditMode = 0,
        ExitingEditMode = 1,
        EnteredPlayMode = 2,
        ExitingPlayMode = 3,
    }

    public static class AssemblyReloadEvents
    {
        public delegate void AssemblyReloadCallback();

        public static event AssemblyReloadCallback beforeAssemblyReload;

        internal static void Reload()
        {
            if (beforeAssemblyReload != null)
            {
                beforeAssemblyReload();
            }
        }
    }

    [AttributeUsage(AttributeTargets.Class)]
    public class InitializeOnLoadAttribute : Attribute
    {
    }

    [AttributeUsage(AttributeTargets.Method)]
    public class InitializeOnLoadMethodAttribute : Attribute
    {
    }

    public sealed class AssetDatabase
    {
        public static T LoadAssetAtPath<T>(string assetPath) where T : Object
        {
            return null;
        }

        public static string GenerateUniqueAssetPath(string path)
        {
            return path;
        }

        public static void CreateAsset(Object asset, string path)
        {
        }

        public static void SaveAssets()
        {
        }

        public static void Refresh()
        {
        }
    }
}
