// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;
using UnityEngine.Stage;

namespace UnityEngine
{
    /// <summary>The legacy input. Stage.Keyboard presses its keys.</summary>
    public class Input
    {
        internal static readonly HashSet<KeyCode> Held = new HashSet<KeyCode>();
        internal static readonly HashSet<KeyCode> Pressed = new HashSet<KeyCode>();
        internal static readonly HashSet<KeyCode> Released = new HashSet<KeyCode>();
        internal static readonly Dictionary<string, float> Axes = new Dictionary<string, float>();

        public static Vector3 mousePosition { get; internal set; }

        public static bool GetKey(KeyCode key)
        {
            MainThread.Check("GetKeyInt");
            return Held.Contains(key);
        }

        public static bool GetKeyDown(KeyCode key)
        {
            MainThread.Check("GetKeyDownInt");
            return Pressed.Contains(key);
        }

        public static bool GetKeyUp(KeyCode key)
        {
            MainThread.Check("GetKeyUpInt");
            return Released.Contains(key);
        }

        public static bool GetMouseButton(int button)
        {
            return GetKey(KeyCode.Mouse0 + button);
        }

        public static bool GetMouseButtonDown(int button)
        {
            return GetKeyDown(KeyCode.Mouse0 + button);
        }

        public static float GetAxis(string axisName)
        {
            MainThread.Check("GetAxis");
            float value;
            Axes.TryGetValue(axisName, out value);
            return value;
        }

        public static float GetAxisRaw(string axisName)
        {
            return GetAxis(axisName);
        }

        internal static void EndFrame()
        {
            Pressed.Clear();
            Released.Clear();
        }
    }

    public enum KeyCode
    {
        None = 0,
        Backspace = 8,
        Tab = 9,
        Return = 13,
        Escape = 27,
        Space = 32,
        A = 97,
        B = 98,
        C = 99,
        D = 100,
        E = 101,
        F = 102,
        Q = 113,
        R = 114,
        S = 115,
        T = 116,
        W = 119,
        X = 120,
        Z = 122,
        UpArrow = 273,
        DownArrow = 274,
        RightArrow = 275,
        LeftArrow = 276,
        RightShift = 303,
        LeftShift = 304,
        Mouse0 = 323,
        Mouse1 = 324,
        Mouse2 = 325,
    }

    public class Cursor
    {
        public static bool visible { get; set; }

        public static CursorLockMode lockState { get; set; }
    }

    public enum CursorLockMode
    {
        None = 0,
        Locked = 1,
        Confined = 2,
    }
}
