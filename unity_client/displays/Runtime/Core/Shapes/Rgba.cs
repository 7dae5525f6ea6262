// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Messages.StdMsgs;

namespace Ros2Gateway.Shapes
{
    /// <summary>A colour of four bytes.</summary>
    public readonly struct Rgba
    {
        /// <summary>Red.</summary>
        public readonly byte r;

        /// <summary>Green.</summary>
        public readonly byte g;

        /// <summary>Blue.</summary>
        public readonly byte b;

        /// <summary>How opaque: 0 is invisible.</summary>
        public readonly byte a;

        /// <summary>Takes the four.</summary>
        public Rgba(byte r, byte g, byte b, byte a = 255)
        {
            this.r = r;
            this.g = g;
            this.b = b;
            this.a = a;
        }

        /// <summary>From shares of 1. Values beyond are cut, NaN is 0.</summary>
        public static Rgba Of(double r, double g, double b, double a) => new Rgba(Byte(r), Byte(g), Byte(b), Byte(a));

        /// <summary>A message's colour. Null is opaque white.</summary>
        public static Rgba Of(ColorRGBAMsg message) =>
            message == null ? new Rgba(255, 255, 255) : Of(message.r, message.g, message.b, message.a);

        /// <summary>As a surface has it whose normal points there, in light from above and a little from ahead.</summary>
        /// <param name="normal">Of length 1, or NaN for a surface without one.</param>
        public Rgba Lit(Vector3<Flu> normal)
        {
            double light = 0.37 * normal.x + 0.25 * normal.y + 0.895 * normal.z; // a direction of length 1
            double share = double.IsNaN(light) ? 0.8 : 0.75 + 0.25 * light; // half of the colour at least
            return new Rgba((byte)(r * share), (byte)(g * share), (byte)(b * share), a);
        }

        /// <inheritdoc/>
        public override string ToString() => "#" + r.ToString("x2") + g.ToString("x2") + b.ToString("x2") + a.ToString("x2");

        private static byte Byte(double share) => !(share > 0) ? (byte)0 : share >= 1 ? (byte)255 : (byte)(share * 255 + 0.5);
    }
}
