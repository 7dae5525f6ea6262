// SPDX-License-Identifier: Apache-2.0
using UnityEngine;

namespace UnityEditor
{
    public class EditorWindow : ScriptableObject
    {
        public static T GetWindow<T>(string title) where T : EditorWindow
        {
            return CreateInstance<T>();
        }

        public void Show()
        {
        }

        public void Repaint()
        {
        }
    }
}
