// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway.Json
{
    public sealed partial class JsonWriter
    {
        /// <summary>Writes an array of truth values. Null is the empty array.</summary>
        public void Values(bool[] v) => Elements(v, (writer, one) => writer.Value(one));

        /// <summary>Writes an array of integers. Null is the empty array.</summary>
        public void Values(sbyte[] v) => Elements(v, (writer, one) => writer.Value(one));

        /// <summary>Writes an array of integers. Null is the empty array.</summary>
        public void Values(short[] v) => Elements(v, (writer, one) => writer.Value(one));

        /// <summary>Writes an array of integers. Null is the empty array.</summary>
        public void Values(ushort[] v) => Elements(v, (writer, one) => writer.Value(one));

        /// <summary>Writes an array of integers. Null is the empty array.</summary>
        public void Values(int[] v) => Elements(v, (writer, one) => writer.Value(one));

        /// <summary>Writes an array of integers. Null is the empty array.</summary>
        public void Values(uint[] v) => Elements(v, (writer, one) => writer.Value(one));

        /// <summary>Writes an array of integers. Null is the empty array.</summary>
        public void Values(long[] v) => Elements(v, (writer, one) => writer.Value(one));

        /// <summary>Writes an array of integers. Null is the empty array.</summary>
        public void Values(ulong[] v) => Elements(v, (writer, one) => writer.Value(one));

        /// <summary>Writes an array of numbers. Null is the empty array.</summary>
        public void Values(float[] v) => Elements(v, (writer, one) => writer.Value(one));

        /// <summary>Writes an array of numbers. Null is the empty array.</summary>
        public void Values(double[] v) => Elements(v, (writer, one) => writer.Value(one));

        /// <summary>Writes an array of texts. Null is the empty array.</summary>
        public void Values(string[] v) => Elements(v, (writer, one) => writer.Value(one));

        private void Elements<T>(T[] values, Action<JsonWriter, T> write)
        {
            BeginArray();
            for (int i = 0; values != null && i < values.Length; i++)
            {
                write(this, values[i]);
            }
            EndArray();
        }
    }
}
