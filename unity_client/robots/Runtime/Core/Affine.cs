// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway.Robots
{
    /// <summary>Turns, scales, shears and moves points: three rows of a matrix, whose fourth is 0, 0, 0, 1.</summary>
    internal sealed class Affine
    {
        private readonly double[] _rows; // 12 of them, row by row

        /// <param name="rows">The first 12 are taken.</param>
        internal Affine(double[] rows) => _rows = rows;

        /// <summary>Whether it makes a right hand a left one.</summary>
        internal bool IsMirroring
        {
            get
            {
                double[] m = _rows;
                double determinant = m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8])
                    + m[2] * (m[4] * m[9] - m[5] * m[8]);
                return determinant < 0;
            }
        }

        /// <summary>Scales along x, y and z.</summary>
        internal static Affine Scaling(double x, double y, double z) =>
            new Affine(new[] { x, 0, 0, 0, 0, y, 0, 0, 0, 0, z, 0 });

        /// <summary>Moves.</summary>
        internal static Affine Moving(double x, double y, double z) =>
            new Affine(new[] { 1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z });

        /// <summary>Turns about an axis of any length but 0, counterclockwise seen against it.</summary>
        internal static Affine Turning(double x, double y, double z, double radians)
        {
            double length = Math.Sqrt(x * x + y * y + z * z);
            x /= length;
            y /= length;
            z /= length;
            double cos = Math.Cos(radians), sin = Math.Sin(radians), rest = 1 - cos;
            return new Affine(new[]
            {
                rest * x * x + cos, rest * x * y - sin * z, rest * x * z + sin * y, 0,
                rest * x * y + sin * z, rest * y * y + cos, rest * y * z - sin * x, 0,
                rest * x * z - sin * y, rest * y * z + sin * x, rest * z * z + cos, 0,
            });
        }

        /// <summary>First the right one, then the left one.</summary>
        public static Affine operator *(Affine left, Affine right)
        {
            double[] product = new double[12];
            for (int row = 0; row < 12; row += 4)
            {
                for (int column = 0; column < 4; column++)
                {
                    product[row + column] = left._rows[row] * right._rows[column]
                        + left._rows[row + 1] * right._rows[4 + column] + left._rows[row + 2] * right._rows[8 + column]
                        + (column == 3 ? left._rows[row + 3] : 0);
                }
            }
            return new Affine(product);
        }

        /// <summary>The new place of a point.</summary>
        /// <param name="values">Has x, y, z from there on.</param>
        internal Vector3<Flu> Place(float[] values, int at)
        {
            double x = values[at], y = values[at + 1], z = values[at + 2];
            double[] m = _rows;
            return new Vector3<Flu>(
                m[0] * x + m[1] * y + m[2] * z + m[3], m[4] * x + m[5] * y + m[6] * z + m[7],
                m[8] * x + m[9] * y + m[10] * z + m[11]);
        }
    }
}
