// SPDX-License-Identifier: Apache-2.0
using System;

namespace UnityEngine.InputSystem
{
    public sealed class InputAction : IDisposable
    {
        private readonly string _name;
        private object _value;
        private int _changedIn;
        private bool _isPressed;

        public InputAction()
            : this(null)
        {
        }

        public InputAction(string name = null, InputActionType type = InputActionType.Value,
            string binding = null, string interactions = null, string processors = null,
            string expectedControlType = null)
        {
            _name = name;
        }

        public event Action<CallbackContext> performed;

        public event Action<CallbackContext> canceled;

        public string name
        {
            get { return _name; }
        }

        public bool enabled { get; private set; }

        public void Enable()
        {
            enabled = true;
        }

        public void Disable()
        {
            enabled = false;
        }

        public TValue ReadValue<TValue>() where TValue : struct
        {
            return enabled && _value is TValue ? (TValue)_value : default(TValue);
        }

        public bool IsPressed()
        {
            return enabled && _isPressed;
        }

        public bool WasPressedThisFrame()
        {
            return enabled && _isPressed && _changedIn == Time.frameCount;
        }

        public bool WasReleasedThisFrame()
        {
            return enabled && !_isPressed && _changedIn == Time.frameCount;
        }

        public void Dispose()
        {
        }

        /// <summary>For the stage: a control has that value from now on.</summary>
        internal void Set(object value, bool isPressed, int frame)
        {
            bool changes = isPressed != _isPressed;
            _value = value;
            _isPressed = isPressed;
            _changedIn = changes ? frame : _changedIn;
            Action<CallbackContext> callback = isPressed ? performed : canceled;
            if (enabled && changes && callback != null)
            {
                callback(new CallbackContext { Action = this });
            }
        }

        public struct CallbackContext
        {
            public InputAction action
            {
                get { return Action; }
            }

            internal InputAction Action { get; set; }

            public TValue ReadValue<TValue>() where TValue : struct
            {
                return Action.ReadValue<TValue>();
            }
        }
    }

    public enum InputActionType
    {
        Value = 0,
        Button = 1,
        PassThrough = 2,
    }

    public class InputActionReference : ScriptableObject
    {
        internal InputAction Action { get; set; }

        public InputAction action
        {
            get { return Action; }
        }
    }

    public struct InputActionProperty
    {
        private readonly InputAction _action;
        private readonly InputActionReference _reference;

        public InputActionProperty(InputAction action)
        {
            _action = action;
            _reference = null;
        }

        public InputActionProperty(InputActionReference reference)
        {
            _action = null;
            _reference = reference;
        }

        public InputAction action
        {
            get { return _reference != null ? _reference.action : _action; }
        }

        public InputActionReference reference
        {
            get { return _reference; }
        }
    }
}

namespace UnityEngine.Stage
{
    using UnityEngine.InputSystem;
    using UnityEngine.InputSystem.Controls;

    /// <summary>Devices and actions for tests: what a person would press.</summary>
    public static class InputSystemDevices
    {
        public static void Connect()
        {
            InputSystem.Keyboard.current = new InputSystem.Keyboard();
            Mouse.current = new Mouse();
        }

        public static void Disconnect()
        {
            InputSystem.Keyboard.current = null;
            Mouse.current = null;
        }

        /// <summary>Presses or releases. It counts as pressed in the frame that comes next.</summary>
        public static void Press(ButtonControl button, bool isPressed = true)
        {
            button.Value = isPressed ? 1F : 0F;
            button.PressedIn = Time.frameCount + 1;
        }

        public static void Move(Mouse mouse, Vector2 delta)
        {
            mouse.Delta.Value = delta;
            mouse.Position.Value = mouse.Position.ReadValue() + delta;
        }

        /// <summary>Gives an action a value (a float, a Vector2). Counts for the frame that comes
        /// next.</summary>
        public static void Set(InputAction action, object value, bool isPressed)
        {
            action.Set(value, isPressed, Time.frameCount + 1);
        }

        public static InputActionReference Reference(InputAction action)
        {
            var reference = ScriptableObject.CreateInstance<InputActionReference>();
            reference.Action = action;
            return reference;
        }
    }
}
