// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Pictures;

namespace Ros2Gateway.Json
{
    public partial class JsonReader
    {
        /// <summary>Reads an array of truth values.</summary>
        /// <param name="length">How many there must be. -1 takes any number.</param>
        public bool[] ReadBools(int length = -1)
        {
            return ReadBools(null, length);
        }

        /// <summary>Like the other. Fills *previous* again if that has the right length.</summary>
        public bool[] ReadBools(bool[] previous, int length = -1)
        {
            BeginArray();
            bool[] values = Room(previous, length);
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

        /// <summary>
        /// Reads an array of integers, or the pixels of a PNG that comes in its place. So the cells of a map take a small
        /// part of the array's size. One subscription that asks for a PNG gets it for all of its client's to the topic.
        /// </summary>
        /// <param name="length">How many there must be. -1 takes any number.</param>
        public sbyte[] ReadInt8s(int length = -1)
        {
            return ReadInt8s(null, length);
        }

        /// <summary>Like the other. Fills *previous* again if that has the right length.</summary>
        public sbyte[] ReadInt8s(sbyte[] previous, int length = -1)
        {
            int typed = TypedArray(72, 1);
            if (typed >= 0)
            {
                return Copied(previous, typed, 1, length);
            }
            if (Kind == JsonKind.String)
            {
                return Pixels(previous, length);
            }
            BeginArray();
            sbyte[] values = Room(previous, length);
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

        private sbyte[] Pixels(sbyte[] previous, int length)
        {
            GreyPng png = new GreyPng(1); // maps come seldom: its buffers need not stay
            string problem = png.Read(ReadBytes());
            if (problem != null)
            {
                throw Error("expected an array or a PNG, but " + problem);
            }
            int count = png.Width * png.Height;
            if (length >= 0 && count != length)
            {
                throw Error("expected " + length + " elements, got " + count);
            }
            sbyte[] pixels = previous != null && previous.Length == count ? previous : new sbyte[count];
            Buffer.BlockCopy(png.Pixels, 0, pixels, 0, count);
            return pixels;
        }

        /// <summary>Reads an array of octets that is written as integers.</summary>
        private protected byte[] ReadUInt8s(byte[] previous, int length)
        {
            int typed = TypedArray(64, 1);
            if (typed >= 0)
            {
                return Copied(previous, typed, 1, length);
            }
            BeginArray();
            byte[] values = Room(previous, length);
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
        /// <param name="length">How many there must be. -1 takes any number.</param>
        public short[] ReadInt16s(int length = -1)
        {
            return ReadInt16s(null, length);
        }

        /// <summary>Like the other. Fills *previous* again if that has the right length.</summary>
        public short[] ReadInt16s(short[] previous, int length = -1)
        {
            int typed = TypedArray(77, 2);
            if (typed >= 0)
            {
                return Copied(previous, typed, 2, length);
            }
            BeginArray();
            short[] values = Room(previous, length);
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
        /// <param name="length">How many there must be. -1 takes any number.</param>
        public ushort[] ReadUInt16s(int length = -1)
        {
            return ReadUInt16s(null, length);
        }

        /// <summary>Like the other. Fills *previous* again if that has the right length.</summary>
        public ushort[] ReadUInt16s(ushort[] previous, int length = -1)
        {
            int typed = TypedArray(69, 2);
            if (typed >= 0)
            {
                return Copied(previous, typed, 2, length);
            }
            BeginArray();
            ushort[] values = Room(previous, length);
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
        /// <param name="length">How many there must be. -1 takes any number.</param>
        public int[] ReadInt32s(int length = -1)
        {
            return ReadInt32s(null, length);
        }

        /// <summary>Like the other. Fills *previous* again if that has the right length.</summary>
        public int[] ReadInt32s(int[] previous, int length = -1)
        {
            int typed = TypedArray(78, 4);
            if (typed >= 0)
            {
                return Copied(previous, typed, 4, length);
            }
            BeginArray();
            int[] values = Room(previous, length);
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
        /// <param name="length">How many there must be. -1 takes any number.</param>
        public uint[] ReadUInt32s(int length = -1)
        {
            return ReadUInt32s(null, length);
        }

        /// <summary>Like the other. Fills *previous* again if that has the right length.</summary>
        public uint[] ReadUInt32s(uint[] previous, int length = -1)
        {
            int typed = TypedArray(70, 4);
            if (typed >= 0)
            {
                return Copied(previous, typed, 4, length);
            }
            BeginArray();
            uint[] values = Room(previous, length);
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
        /// <param name="length">How many there must be. -1 takes any number.</param>
        public long[] ReadInt64s(int length = -1)
        {
            return ReadInt64s(null, length);
        }

        /// <summary>Like the other. Fills *previous* again if that has the right length.</summary>
        public long[] ReadInt64s(long[] previous, int length = -1)
        {
            int typed = TypedArray(79, 8);
            if (typed >= 0)
            {
                return Copied(previous, typed, 8, length);
            }
            BeginArray();
            long[] values = Room(previous, length);
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
        /// <param name="length">How many there must be. -1 takes any number.</param>
        public ulong[] ReadUInt64s(int length = -1)
        {
            return ReadUInt64s(null, length);
        }

        /// <summary>Like the other. Fills *previous* again if that has the right length.</summary>
        public ulong[] ReadUInt64s(ulong[] previous, int length = -1)
        {
            int typed = TypedArray(71, 8);
            if (typed >= 0)
            {
                return Copied(previous, typed, 8, length);
            }
            BeginArray();
            ulong[] values = Room(previous, length);
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

        /// <summary>Reads an array of numbers. Null is NaN.</summary>
        /// <param name="length">How many there must be. -1 takes any number.</param>
        public float[] ReadFloat32s(int length = -1)
        {
            return ReadFloat32s(null, length);
        }

        /// <summary>Like the other. Fills *previous* again if that has the right length.</summary>
        public float[] ReadFloat32s(float[] previous, int length = -1)
        {
            int typed = TypedArray(85, 4);
            if (typed >= 0)
            {
                return Copied(previous, typed, 4, length);
            }
            BeginArray();
            float[] values = Room(previous, length);
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

        /// <summary>Reads an array of numbers. Null is NaN.</summary>
        /// <param name="length">How many there must be. -1 takes any number.</param>
        public double[] ReadFloat64s(int length = -1)
        {
            return ReadFloat64s(null, length);
        }

        /// <summary>Like the other. Fills *previous* again if that has the right length.</summary>
        public double[] ReadFloat64s(double[] previous, int length = -1)
        {
            int typed = TypedArray(86, 8);
            if (typed >= 0)
            {
                return Copied(previous, typed, 8, length);
            }
            BeginArray();
            double[] values = Room(previous, length);
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
        /// <param name="length">How many there must be. -1 takes any number.</param>
        public string[] ReadStrings(int length = -1)
        {
            return ReadStrings(null, length);
        }

        /// <summary>Like the other. Fills *previous* again if that has the right length.</summary>
        public string[] ReadStrings(string[] previous, int length = -1)
        {
            BeginArray();
            string[] values = Room(previous, length);
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
        /// Enters and leaves a typed array of RFC 8746 whose bytes are as they are in memory: *_position* is then
        /// at the bytes, which are the caller's to pass over.
        /// </summary>
        /// <returns>How many elements it has. -1 if no such array comes next, as in JSON.</returns>
        internal virtual int TypedArray(int tag, int elementBytes)
        {
            return -1;
        }

        private T[] Copied<T>(T[] previous, int count, int elementBytes, int length)
        {
            if (length >= 0 && count != length)
            {
                throw WrongLength(count, length);
            }
            T[] values = previous != null && previous.Length == count ? previous
                : count == 0 ? Array.Empty<T>() : new T[count];
            Buffer.BlockCopy(_buffer, _position, values, 0, count * elementBytes);
            _position += count * elementBytes;
            return values;
        }

        private T[] Room<T>(T[] previous, int length)
        {
            int room = RoomFor(length);
            return previous != null && previous.Length == room ? previous : new T[room];
        }

        /// <summary>
        /// Counts the elements of the array that was entered, by their commas. The count is right for numbers,
        /// a first guess for texts with commas, and never more than the bytes that are there.
        /// </summary>
        internal virtual int RoomFor(int length)
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
