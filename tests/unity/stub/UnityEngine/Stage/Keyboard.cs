// SPDX-License-Identifier: Apache-2.0
namespace UnityEngine.Stage
{
    /// <summary>Presses keys for the legacy input.</summary>
    public static class Keyboard
    {
        public static void Press(KeyCode key)
        {
            if (Input.Held.Add(key))
            {
                Input.Pressed.Add(key);
            }
        }

        public static void Release(KeyCode key)
        {
            if (Input.Held.Remove(key))
            {
                Input.Released.Add(key);
            }
        }

        public static void SetAxis(string name, float value)
        {
            Input.Axes[name] = value;
        }
    }
}
