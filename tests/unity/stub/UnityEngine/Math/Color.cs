// SPDX-License-Identifier: Apache-2.0
using System;

namespace UnityEngine
{
    public struct Color : IEquatable<Color>
    {
        public float r;
        public float g;
        public float b;
        public float a;

        public Color(float r, float g, float b, float a)
        {
            this.r = r;
            this.g = g;
            this.b = b;
            this.a = a;
        }

        public Color(float r, float g, float b)
            : this(r, g, b, 1F)
        {
        }

        public static Color red
        {
            get { return new Color(1F, 0F, 0F, 1F); }
        }

        public static Color green
        {
            get { return new Color(0F, 1F, 0F, 1F); }
        }

        public static Color blue
        {
            get { return new Color(0F, 0F, 1F, 1F); }
        }

        public static Color white
        {
            get { return new Color(1F, 1F, 1F, 1F); }
        }

        public static Color black
        {
            get { return new Color(0F, 0F, 0F, 1F); }
        }

        public static Color yellow
        {
            get { return new Color(1F, 235F / 255F, 4F / 255F, 1F); }
        }

        public static Color cyan
        {
            get { return new Color(0F, 1F, 1F, 1F); }
        }

        public static Color gray
        {
            get { return new Color(.5F, .5F, .5F, 1F); }
        }

        public static Color clear
        {
            get { return new Color(0F, 0F, 0F, 0F); }
        }

        public static Color Lerp(Color a, Color b, float t)
        {
            t = Mathf.Clamp01(t);
            return new Color(
                a.r + (b.r - a.r) * t, a.g + (b.g - a.g) * t, a.b + (b.b - a.b) * t, a.a + (b.a - a.a) * t);
        }

        public static Color HSVToRGB(float H, float S, float V)
        {
            return new Color(Part(H, S, V, 5F), Part(H, S, V, 3F), Part(H, S, V, 1F));
        }

        public static bool operator ==(Color lhs, Color rhs)
        {
            float r = lhs.r - rhs.r;
            float g = lhs.g - rhs.g;
            float b = lhs.b - rhs.b;
            float a = lhs.a - rhs.a;
            return r * r + g * g + b * b + a * a < 1E-10F;
        }

        public static bool operator !=(Color lhs, Color rhs)
        {
            return !(lhs == rhs);
        }

        public bool Equals(Color other)
        {
            return r == other.r && g == other.g && b == other.b && a == other.a;
        }

        public override bool Equals(object other)
        {
            return other is Color && Equals((Color)other);
        }

        public override int GetHashCode()
        {
            return ((r.GetHashCode() * 31 + g.GetHashCode()) * 31 + b.GetHashCode()) * 31 + a.GetHashCode();
        }

        public override string ToString()
        {
            return string.Format(System.Globalization.CultureInfo.InvariantCulture,
                "RGBA({0:F3}, {1:F3}, {2:F3}, {3:F3})", r, g, b, a);
        }

        private static float Part(float hue, float saturation, float value, float offset)
        {
            float k = (offset + hue * 6F) % 6F;
            return value - value * saturation * Mathf.Max(0F, Mathf.Min(Mathf.Min(k, 4F - k), 1F));
        }
    }

    public struct Color32
    {
        public byte r;
        public byte g;
        public byte b;
        public byte a;

        public Color32(byte r, byte g, byte b, byte a)
        {
            this.r = r;
            this.g = g;
            this.b = b;
            this.a = a;
        }

        public static implicit operator Color32(Color c)
        {
            return new Color32(ToByte(c.r), ToByte(c.g), ToByte(c.b), ToByte(c.a));
        }

        public static implicit operator Color(Color32 c)
        {
            return new Color(c.r / 255F, c.g / 255F, c.b / 255F, c.a / 255F);
        }

        private static byte ToByte(float value)
        {
            return (byte)Mathf.Round(Mathf.Clamp01(value) * 255F);
        }
    }
}
