// SPDX-License-Identifier: Apache-2.0
using UnityEngine.InputSystem.Controls;

namespace UnityEngine.InputSystem
{
    public abstract class InputControl
    {
        internal object Value { get; set; }
    }

    public abstract class InputControl<TValue> : InputControl where TValue : struct
    {
        public TValue ReadValue()
        {
            return Value == null ? default(TValue) : (TValue)Value;
        }
    }

    public class InputDevice : InputControl
    {
    }

    public class Pointer : InputDevice
    {
        internal readonly Vector2Control Position = new Vector2Control();
        internal readonly Vector2Control Delta = new Vector2Control();

        public Vector2Control position
        {
            get { return Position; }
        }

        // a DeltaControl, derived from this, since 1.4 of the package
        public Vector2Control delta
        {
            get { return Delta; }
        }
    }

    public class Mouse : Pointer
    {
        private readonly ButtonControl _leftButton = new ButtonControl();
        private readonly ButtonControl _rightButton = new ButtonControl();

        public static Mouse current { get; internal set; }

        public ButtonControl leftButton
        {
            get { return _leftButton; }
        }

        public ButtonControl rightButton
        {
            get { return _rightButton; }
        }
    }

    public class Keyboard : InputDevice
    {
        private readonly KeyControl[] _keys = new KeyControl[128];

        public static Keyboard current { get; internal set; }

        public KeyControl this[Key key]
        {
            get { return _keys[(int)key] ?? (_keys[(int)key] = new KeyControl()); }
        }

        public KeyControl wKey
        {
            get { return this[Key.W]; }
        }

        public KeyControl aKey
        {
            get { return this[Key.A]; }
        }

        public KeyControl sKey
        {
            get { return this[Key.S]; }
        }

        public KeyControl dKey
        {
            get { return this[Key.D]; }
        }

        public KeyControl spaceKey
        {
            get { return this[Key.Space]; }
        }

        public KeyControl escapeKey
        {
            get { return this[Key.Escape]; }
        }

        public KeyControl upArrowKey
        {
            get { return this[Key.UpArrow]; }
        }

        public KeyControl downArrowKey
        {
            get { return this[Key.DownArrow]; }
        }

        public KeyControl leftArrowKey
        {
            get { return this[Key.LeftArrow]; }
        }

        public KeyControl rightArrowKey
        {
            get { return this[Key.RightArrow]; }
        }
    }

    public enum Key
    {
        None = 0,
        Space = 1,
        A = 15,
        D = 18,
        S = 33,
        W = 37,
        Escape = 60,
        LeftArrow = 61,
        RightArrow = 62,
        UpArrow = 63,
        DownArrow = 64,
    }
}

namespace UnityEngine.InputSystem.Controls
{
    public class AxisControl : InputControl<float>
    {
    }

    public class ButtonControl : AxisControl
    {
        public bool isPressed
        {
            get { return ReadValue() >= 0.5F; }
        }

        public bool wasPressedThisFrame
        {
            get { return isPressed && PressedIn == Time.frameCount; }
        }

        internal int PressedIn { get; set; }
    }

    public class KeyControl : ButtonControl
    {
    }

    public class Vector2Control : InputControl<Vector2>
    {
    }
}
