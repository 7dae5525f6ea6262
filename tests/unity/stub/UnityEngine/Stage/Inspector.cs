// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;

namespace UnityEngine.Stage
{
    /// <summary>Someone in front of an inspector: what is clicked, typed and read.</summary>
    public static class Inspector
    {
        /// <summary>The items of the menu that was shown last, with their actions. Null for those that
        /// are disabled.</summary>
        public static readonly Dictionary<string, Action> Menu = new Dictionary<string, Action>();

        /// <summary>The help boxes since the last call of <see cref="Look"/>.</summary>
        public static readonly List<string> Words = new List<string>();

        /// <summary>The buttons and toggles since the last call of <see cref="Look"/>.</summary>
        public static readonly List<string> Buttons = new List<string>();

        /// <summary>The toggles since the last call of <see cref="Look"/>, and whether each is on.</summary>
        public static readonly Dictionary<string, bool> Toggles = new Dictionary<string, bool>();

        /// <summary>The properties that were changed by way of a SerializedObject: an instance of a prefab keeps such
        /// changes, and loses what is written into its fields.</summary>
        public static readonly List<string> Applied = new List<string>();

        private static readonly Dictionary<string, string> Typed = new Dictionary<string, string>();
        private static string _clicked;

        /// <summary>Draws once, with a button clicked, if one is named.</summary>
        public static void Look(Action draw, string click = null)
        {
            Words.Clear();
            Toggles.Clear();
            Buttons.Clear();
            _clicked = click;
            draw();
            _clicked = null;
        }

        /// <summary>Writes into a field, from the next look on.</summary>
        public static void Write(string label, string text)
        {
            Typed[label] = text;
        }

        internal static bool IsClicked(string text)
        {
            Buttons.Add(text);
            return text == _clicked;
        }

        internal static string Field(string label, string text)
        {
            string typed;
            return Typed.TryGetValue(label, out typed) ? typed : text;
        }
    }
}
