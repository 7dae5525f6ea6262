// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using UnityEngine.Stage;

namespace UnityEngine.SceneManagement
{
    public struct Scene
    {
        internal readonly int Number;

        internal Scene(int number)
        {
            Number = number;
        }

        public static bool operator ==(Scene lhs, Scene rhs)
        {
            return lhs.Number == rhs.Number;
        }

        public static bool operator !=(Scene lhs, Scene rhs)
        {
            return lhs.Number != rhs.Number;
        }

        public override bool Equals(object other)
        {
            return other is Scene && this == (Scene)other;
        }

        public override int GetHashCode()
        {
            return Number;
        }
    }

    public class SceneManager
    {
        internal static readonly Scene Lasting = new Scene(-1); // of what is not destroyed on load

        private static readonly List<int> Loaded = new List<int> { 0 };
        private static Scene _active;
        private static int _last;

        public static Scene GetActiveScene()
        {
            MainThread.Check("GetActiveScene");
            return _active;
        }

        public static bool SetActiveScene(Scene scene)
        {
            MainThread.Check("SetActiveScene");
            bool isLoaded = IsLoaded(scene);
            _active = isLoaded ? scene : _active;
            return isLoaded;
        }

        public static Scene CreateScene(string sceneName)
        {
            MainThread.Check("CreateScene");
            _last++;
            Loaded.Add(_last);
            return new Scene(_last);
        }

        public static AsyncOperation UnloadSceneAsync(Scene scene)
        {
            MainThread.Check("UnloadSceneAsync");
            if (!IsLoaded(scene) || Loaded.Count == 1)
            {
                throw new ArgumentException("Scene to unload is invalid, or the last one");
            }
            Loaded.Remove(scene.Number);
            _active = _active == scene ? new Scene(Loaded[0]) : _active;
            foreach (Object target in Stage.Scene.Objects.ToArray())
            {
                var root = target as GameObject;
                if (root != null && root.transform.parent == null && root.scene == scene)
                {
                    Object.DestroyImmediate(root);
                }
            }
            return new AsyncOperation();
        }

        internal static bool IsLoaded(Scene scene)
        {
            return Loaded.Contains(scene.Number);
        }
    }
}

namespace UnityEngine
{
    public class AsyncOperation : YieldInstruction
    {
    }
}
