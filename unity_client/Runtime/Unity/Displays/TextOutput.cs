// SPDX-License-Identifier: Apache-2.0
using System;
using UnityEngine;
using UnityEngine.Events;
#if ROS2GATEWAY_UGUI
using UnityEngine.UI;
#endif

namespace Ros2Gateway.Unity
{
    /// <summary>A text, for the Inspector's lists of what to call.</summary>
    [Serializable]
    public sealed class TextEvent : UnityEvent<string>
    {
    }

    /// <summary>Where a display writes: a TextMesh or Text beside or below it, and whoever listens.</summary>
    [Serializable]
    public sealed class TextOutput
    {
        [SerializeField]
        [Tooltip("Other places for the text, such as the text of a TextMesh Pro")]
        private TextEvent _onChanged = new TextEvent();

        private TextMesh _mesh;
#if ROS2GATEWAY_UGUI
        private Text _label;
#endif

        /// <summary>What is shown.</summary>
        public string Text { get; private set; }

        /// <summary>Called with each new text, from the Inspector's list.</summary>
        public TextEvent OnChanged
        {
            get { return _onChanged; }
        }

        /// <summary>Finds the place; false if there is none.</summary>
        /// <param name="isRich">Whether tags such as &lt;color&gt; are obeyed.</param>
        internal bool Find(Component display, bool isRich)
        {
            _mesh = display.GetComponentInChildren<TextMesh>();
            if (_mesh != null)
            {
                _mesh.richText = isRich;
            }
            bool isFound = _mesh != null || _onChanged.GetPersistentEventCount() > 0;
#if ROS2GATEWAY_UGUI
            _label = display.GetComponentInChildren<Text>();
            if (_label != null)
            {
                _label.supportRichText = isRich;
                isFound = true;
            }
#endif
            return isFound;
        }

        /// <summary>Like <see cref="Find"/>, for a display that has nothing else to show: warns.</summary>
        internal void Demand(Component display, bool isRich)
        {
            if (!Find(display, isRich))
            {
                Debug.LogWarning(
                    display.GetType().Name + " on " + display.name
                    + " finds no TextMesh or Text: add one beside or below it", display);
            }
        }

        internal void Show(string text)
        {
            if (text == Text)
            {
                return;
            }
            Text = text;
            if (_mesh != null)
            {
                _mesh.text = text;
            }
#if ROS2GATEWAY_UGUI
            if (_label != null)
            {
                _label.text = text;
            }
#endif
            _onChanged.Invoke(text);
        }

        internal void Paint(Color color)
        {
            if (_mesh != null)
            {
                _mesh.color = color;
            }
#if ROS2GATEWAY_UGUI
            if (_label != null)
            {
                _label.color = color;
            }
#endif
        }
    }
}
