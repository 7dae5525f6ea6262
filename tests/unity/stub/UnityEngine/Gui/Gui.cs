// SPDX-License-Identifier: Apache-2.0
using UnityEngine.Stage;

namespace UnityEngine
{
    public class GUIContent
    {
        public static GUIContent none = new GUIContent("");

        public GUIContent()
            : this("")
        {
        }

        public GUIContent(string text)
            : this(text, "")
        {
        }

        public GUIContent(string text, string tooltip)
        {
            this.text = text;
            this.tooltip = tooltip;
        }

        public string text { get; set; }

        public string tooltip { get; set; }
    }

    public sealed class GUIStyle
    {
        public GUIStyle()
        {
        }

        public GUIStyle(GUIStyle other)
        {
            fontSize = other.fontSize;
            wordWrap = other.wordWrap;
            richText = other.richText;
        }

        public int fontSize { get; set; }

        public bool wordWrap { get; set; }

        public bool richText { get; set; }
    }

    public class GUI
    {
        public static bool enabled { get; set; }

        public static Color color { get; set; }

        public static void Label(Rect position, string text)
        {
        }

        public static void Box(Rect position, string text)
        {
        }
    }

    public class GUIUtility
    {
    }

    public sealed class GUILayoutOption
    {
        internal GUILayoutOption()
        {
        }
    }

    public class GUILayout
    {
        public static void Label(string text, params GUILayoutOption[] options)
        {
        }

        public static bool Button(string text, params GUILayoutOption[] options)
        {
            return Inspector.IsClicked(text);
        }

        public static bool Button(GUIContent content, params GUILayoutOption[] options)
        {
            return Inspector.IsClicked(content.text);
        }

        public static GUILayoutOption Width(float width)
        {
            return new GUILayoutOption();
        }

        public static void BeginArea(Rect screenRect)
        {
        }

        public static void EndArea()
        {
        }
    }
}

namespace UnityEngine
{
    public enum FocusType
    {
        Keyboard = 1,
        Passive = 2,
    }
}
