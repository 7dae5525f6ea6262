// SPDX-License-Identifier: Apache-2.0
namespace Ros2Gateway.Json
{
    public sealed partial class JsonWriter
    {
        /// <summary>Writes an array of truth values. Null is the empty array.</summary>
        public void Values(bool[] v)
        {
            BeginArray();
            for (int i = 0; v != null && i < v.Length; i++)
            {
                Value(v[i]);
            }
            EndArray();
        }

        /// <summary>Writes an array of integers. Null is the empty array.</summary>
        public void Values(sbyte[] v)
        {
            BeginArray();
            for (int i = 0; v != null && i < v.Length; i++)
            {
                Value(v[i]);
            }
            EndArray();
        }

        /// <summary>Writes an array of integers. Null is the empty array.</summary>
        public void Values(short[] v)
        {
            BeginArray();
            for (int i = 0; v != null && i < v.Length; i++)
            {
                Value(v[i]);
            }
            EndArray();
        }

        /// <summary>Writes an array of integers. Null is the empty array.</summary>
        public void Values(ushort[] v)
        {
            BeginArray();
            for (int i = 0; v != null && i < v.Length; i++)
            {
                Value(v[i]);
            }
            EndArray();
        }

        /// <summary>Writes an array of integers. Null is the empty array.</summary>
        public void Values(int[] v)
        {
            BeginArray();
            for (int i = 0; v != null && i < v.Length; i++)
            {
                Value(v[i]);
            }
            EndArray();
        }

        /// <summary>Writes an array of integers. Null is the empty array.</summary>
        public void Values(uint[] v)
        {
            BeginArray();
            for (int i = 0; v != null && i < v.Length; i++)
            {
                Value(v[i]);
            }
            EndArray();
        }

        /// <summary>Writes an array of integers. Null is the empty array.</summary>
        public void Values(long[] v)
        {
            BeginArray();
            for (int i = 0; v != null && i < v.Length; i++)
            {
                Value(v[i]);
            }
            EndArray();
        }

        /// <summary>Writes an array of integers. Null is the empty array.</summary>
        public void Values(ulong[] v)
        {
            BeginArray();
            for (int i = 0; v != null && i < v.Length; i++)
            {
                Value(v[i]);
            }
            EndArray();
        }

        /// <summary>
        /// Writes an array of numbers as <see cref="Value(float)"/> does. Null is the empty array.
        /// </summary>
        public void Values(float[] v)
        {
            BeginArray();
            for (int i = 0; v != null && i < v.Length; i++)
            {
                Value(v[i]);
            }
            EndArray();
        }

        /// <summary>
        /// Writes an array of numbers as <see cref="Value(double)"/> does. Null is the empty array.
        /// </summary>
        public void Values(double[] v)
        {
            BeginArray();
            for (int i = 0; v != null && i < v.Length; i++)
            {
                Value(v[i]);
            }
            EndArray();
        }

        /// <summary>Writes an array of texts. Null is the empty array.</summary>
        public void Values(string[] v)
        {
            BeginArray();
            for (int i = 0; v != null && i < v.Length; i++)
            {
                Value(v[i]);
            }
            EndArray();
        }
    }
}
