// SPDX-License-Identifier: Apache-2.0
using System;
using UnityEngine;
using UnityEngine.Events;
#if ROS2GATEWAY_UGUI
using UnityEngine.UI;
#endif
#if ROS2GATEWAY_TMP
using TMPro;
#endif

namespace Ros2Gateway.Unity
{
    /// <summary>A text, for the Inspector's lists of what to call.</summary>
    [Serializable]
    public sealed class TextEvent : UnityEvent<string>
    {
    }

    /// <summary>
    /// The places where a display writes: a TextMesh Pro, Text or TextMesh next to or below it, and all listeners.
    /// </summary>
    [Serializable]
    public sealed class TextOutput
    {
        [SerializeField]
        [Tooltip("Other places for the text, such as a method of your component")]
        private TextEvent _onChanged = new();

        private readonly Listeners<string> _changed;
        private Component _display; // whose it is
        private Action<string> _write; // into all texts that were found. Null without one
        private Action<Color> _paint;

        /// <summary>A part of a display. Made by Unity as well.</summary>
        public TextOutput()
        {
            _changed = new Listeners<string>(
                (where, error, times) => FaultLog.Write(_display, where, error, times), "listener of On Changed");
            _changed.Add(text => _onChanged.Invoke(text));
        }

        /// <summary>What is shown.</summary>
        public string Text { get; private set; }

        /// <summary>Called with each new text, from the Inspector's list.</summary>
        public TextEvent OnChanged => _onChanged;

        /// <summary>Finds the place. False without one.</summary>
        /// <param name="isRich">Whether tags such as &lt;color&gt; are obeyed.</param>
        internal bool Find(Component display, bool isRich)
        {
            _display = display;
            _write = null;
            _paint = null;
            TextMesh mesh = display.GetComponentInChildren<TextMesh>();
            if (mesh != null)
            {
                mesh.richText = isRich;
                Add(mesh, text => mesh.text = text, color => mesh.color = color);
            }
#if ROS2GATEWAY_UGUI
            Text label = display.GetComponentInChildren<Text>();
            if (label != null)
            {
                label.supportRichText = isRich;
                Add(label, text => label.text = text, color => label.color = color);
            }
#endif
#if ROS2GATEWAY_TMP
            TMP_Text textMeshPro = display.GetComponentInChildren<TMP_Text>();
            if (textMeshPro != null)
            {
                textMeshPro.richText = isRich;
                textMeshPro.parseCtrlCharacters = false; // a robot's \n is two characters
                Add(textMeshPro, text => textMeshPro.text = text, color => textMeshPro.color = color);
            }
#endif
            return _write != null || _onChanged.GetPersistentEventCount() > 0;
        }

        /// <summary>Like <see cref="Find"/>, for a display that has nothing else to show: warns.</summary>
        internal void Demand(Component display, bool isRich)
        {
            if (!Find(display, isRich))
            {
                Debug.LogWarning(
                    display.GetType().Name + " on " + display.name
                    + " finds no TextMesh Pro, Text or TextMesh: add one to it or below it", display);
            }
        }

        internal void Show(string text)
        {
            if (text == Text)
            {
                return;
            }
            Text = text;
            if (_write != null)
            {
                _write(text);
            }
            _changed.Call(text);
        }

        internal void Paint(Color color)
        {
            if (_paint != null)
            {
                _paint(color);
            }
        }

        private void Add(Component place, Action<string> write, Action<Color> paint)
        {
            _write += text =>
            {
                if (place != null) // it may have been destroyed in the meantime
                {
                    write(text);
                }
            };
            _paint += color =>
            {
                if (place != null)
                {
                    paint(color);
                }
            };
        }
    }
}
