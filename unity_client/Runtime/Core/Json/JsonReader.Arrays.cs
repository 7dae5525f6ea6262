// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway.Json
{
    public sealed partial class JsonReader
    {
        /// <summary>Reads an array of truth values.</summary>
        /// <param name="length">How many there must be; -1 takes any number.</param>
        public bool[] ReadBools(int length = -1)
        {
            BeginArray();
            var values = new bool[RoomFor(length)];
            int count = 0;
            while (NextElement())
            {
                if (count == values.Length)
                {
                    Grow(ref values, length);
                }
                values[count++] = ReadBool();
            }
            return Trimmed(values, count, length);
        }

        /// <summary>Reads an array of integers.</summary>
        /// <param name="length">How many there must be; -1 takes any number.</param>
        public sbyte[] ReadInt8s(int length = -1)
        {
            BeginArray();
            var values = new sbyte[RoomFor(length)];
            int count = 0;
            while (NextElement())
            {
                if (count == values.Length)
                {
                    Grow(ref values, length);
                }
                values[count++] = ReadInt8();
            }
            return Trimmed(values, count, length);
        }

        private byte[] ReadUInt8s(int length)
        {
            BeginArray();
            var values = new byte[RoomFor(length)];
            int count = 0;
            while (NextElement())
            {
                if (count == values.Length)
                {
                    Grow(ref values, length);
                }
                values[count++] = ReadUInt8();
            }
            return Trimmed(values, count, length);
        }

        /// <summary>Reads an array of integers.</summary>
        /// <param name="length">How many there must be; -1 takes any number.</param>
        public short[] ReadInt16s(int length = -1)
        {
            BeginArray();
            var values = new short[RoomFor(length)];
            int count = 0;
            while (NextElement())
            {
                if (count == values.Length)
                {
                    Grow(ref values, length);
                }
                values[count++] = ReadInt16();
            }
            return Trimmed(values, count, length);
        }

        /// <summary>Reads an array of integers.</summary>
        /// <param name="length">How many there must be; -1 takes any number.</param>
        public ushort[] ReadUInt16s(int length = -1)
        {
            BeginArray();
            var values = new ushort[RoomFor(length)];
            int count = 0;
            while (NextElement())
            {
                if (count == values.Length)
                {
                    Grow(ref values, length);
                }
                values[count++] = ReadUInt16();
            }
            return Trimmed(values, count, length);
        }

        /// <summary>Reads an array of integers.</summary>
        /// <param name="length">How many there must be; -1 takes any number.</param>
        public int[] ReadInt32s(int length = -1)
        {
            BeginArray();
            var values = new int[RoomFor(length)];
            int count = 0;
            while (NextElement())
            {
                if (count == values.Length)
                {
                    Grow(ref values, length);
                }
                values[count++] = ReadInt32();
            }
            return Trimmed(values, count, length);
        }

        /// <summary>Reads an array of integers.</summary>
        /// <param name="length">How many there must be; -1 takes any number.</param>
        public uint[] ReadUInt32s(int length = -1)
        {
            BeginArray();
            var values = new uint[RoomFor(length)];
            int count = 0;
            while (NextElement())
            {
                if (count == values.Length)
                {
                    Grow(ref values, length);
                }
                values[count++] = ReadUInt32();
            }
            return Trimmed(values, count, length);
        }

        /// <summary>Reads an array of integers.</summary>
        /// <param name="length">How many there must be; -1 takes any number.</param>
        public long[] ReadInt64s(int length = -1)
        {
            BeginArray();
            var values = new long[RoomFor(length)];
            int count = 0;
            while (NextElement())
            {
                if (count == values.Length)
                {
                    Grow(ref values, length);
                }
                values[count++] = ReadInt64();
            }
            return Trimmed(values, count, length);
        }

        /// <summary>Reads an array of integers.</summary>
        /// <param name="length">How many there must be; -1 takes any number.</param>
        public ulong[] ReadUInt64s(int length = -1)
        {
            BeginArray();
            var values = new ulong[RoomFor(length)];
            int count = 0;
            while (NextElement())
            {
                if (count == values.Length)
                {
                    Grow(ref values, length);
                }
                values[count++] = ReadUInt64();
            }
            return Trimmed(values, count, length);
        }

        /// <summary>Reads an array of numbers; null is NaN.</summary>
        /// <param name="length">How many there must be; -1 takes any number.</param>
        public float[] ReadFloat32s(int length = -1)
        {
            BeginArray();
            var values = new float[RoomFor(length)];
            int count = 0;
            while (NextElement())
            {
                if (count == values.Length)
                {
                    Grow(ref values, length);
                }
                values[count++] = ReadFloat32();
            }
            return Trimmed(values, count, length);
        }

        /// <summary>Reads an array of numbers; null is NaN.</summary>
        /// <param name="length">How many there must be; -1 takes any number.</param>
        public double[] ReadFloat64s(int length = -1)
        {
            BeginArray();
            var values = new double[RoomFor(length)];
            int count = 0;
            while (NextElement())
            {
                if (count == values.Length)
                {
                    Grow(ref values, length);
                }
                values[count++] = ReadFloat64();
            }
            return Trimmed(values, count, length);
        }

        /// <summary>Reads an array of texts.</summary>
        /// <param name="length">How many there must be; -1 takes any number.</param>
        public string[] ReadStrings(int length = -1)
        {
            BeginArray();
            var values = new string[RoomFor(length)];
            int count = 0;
            while (NextElement())
            {
                if (count == values.Length)
                {
                    Grow(ref values, length);
                }
                values[count++] = ReadString();
            }
            return Trimmed(values, count, length);
        }

        internal JsonFormatException WrongLength(int count, int length)
        {
            return Error("expected " + length + " elements, got " + count);
        }

        /// <summary>
        /// Counts the elements of the array that was entered, by their commas: what is right for numbers is a
        /// first guess for texts with commas, and never more than the bytes that are there.
        /// </summary>
        private int RoomFor(int length)
        {
            byte[] buffer = _buffer;
            int end = _end;
            int commas = 0;
            for (int at = _position; at < end && buffer[at] != (byte)']'; at++)
            {
                commas += buffer[at] == (byte)',' ? 1 : 0;
            }
            return length >= 0 ? Math.Min(length, commas + 1) : commas > 0 ? commas + 1 : 1;
        }

        private void Grow<T>(ref T[] values, int length)
        {
            if (values.Length == length)
            {
                throw Error("expected " + length + " elements, got more");
            }
            Array.Resize(ref values, Math.Max(4, 2 * values.Length));
        }

        private T[] Trimmed<T>(T[] values, int count, int length)
        {
            if (length >= 0 && count != length)
            {
                throw WrongLength(count, length);
            }
            if (count == 0)
            {
                return Array.Empty<T>();
            }
            if (count < values.Length)
            {
                Array.Resize(ref values, count);
            }
            return values;
        }
    }
}
