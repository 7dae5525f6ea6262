// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway.Json
{
    /// <remarks>
    /// Each array takes the one before, which it fills again if that has the right length, and how many elements there
    /// must be. -1 takes any number.
    /// </remarks>
    public partial class JsonReader
    {
        private const int Untyped = -1;

        /// <summary>
        /// Unpacks octets that come in place of an array of int8, such as the PNG of a map. Null refuses them. A
        /// FormatException of it says what is wrong.
        /// </summary>
        public Func<byte[], sbyte[]> PackedInt8s { get; set; }

        /// <summary>Reads an array of truth values.</summary>
        public bool[] ReadBools(bool[] previous = null, int length = -1) =>
            ReadArray(previous, length, Untyped, reader => reader.ReadBool());

        /// <summary>
        /// Reads an array of integers, or what <see cref="PackedInt8s"/> makes of octets that come in its place.
        /// </summary>
        public sbyte[] ReadInt8s(sbyte[] previous = null, int length = -1) =>
            Kind == JsonKind.String ? Unpacked(length) : ReadArray(previous, length, 72, reader => reader.ReadInt8());

        /// <summary>Reads an array of integers.</summary>
        public short[] ReadInt16s(short[] previous = null, int length = -1) =>
            ReadArray(previous, length, 77, reader => reader.ReadInt16());

        /// <summary>Reads an array of integers.</summary>
        public ushort[] ReadUInt16s(ushort[] previous = null, int length = -1) =>
            ReadArray(previous, length, 69, reader => reader.ReadUInt16());

        /// <summary>Reads an array of integers.</summary>
        public int[] ReadInt32s(int[] previous = null, int length = -1) =>
            ReadArray(previous, length, 78, reader => reader.ReadInt32());

        /// <summary>Reads an array of integers.</summary>
        public uint[] ReadUInt32s(uint[] previous = null, int length = -1) =>
            ReadArray(previous, length, 70, reader => reader.ReadUInt32());

        /// <summary>Reads an array of integers.</summary>
        public long[] ReadInt64s(long[] previous = null, int length = -1) =>
            ReadArray(previous, length, 79, reader => reader.ReadInt64());

        /// <summary>Reads an array of integers.</summary>
        public ulong[] ReadUInt64s(ulong[] previous = null, int length = -1) =>
            ReadArray(previous, length, 71, reader => reader.ReadUInt64());

        /// <summary>Reads an array of numbers. Null is NaN.</summary>
        public float[] ReadFloat32s(float[] previous = null, int length = -1) =>
            ReadArray(previous, length, 85, reader => reader.ReadFloat32());

        /// <summary>Reads an array of numbers. Null is NaN.</summary>
        public double[] ReadFloat64s(double[] previous = null, int length = -1) =>
            ReadArray(previous, length, 86, reader => reader.ReadFloat64());

        /// <summary>Reads an array of texts.</summary>
        public string[] ReadStrings(string[] previous = null, int length = -1) =>
            ReadArray(previous, length, Untyped, reader => reader.ReadString());

        private sbyte[] Unpacked(int length)
        {
            if (PackedInt8s == null)
            {
                throw Unexpected("an array of integers");
            }
            byte[] packed = ReadBytes();
            try
            {
                sbyte[] values = PackedInt8s(packed);
                return Trimmed(values, values.Length, length);
            }
            catch (FormatException error)
            {
                throw Error("expected an array or a PNG, but " + error.Message);
            }
        }

        /// <param name="tag">Of the typed array (RFC 8746) whose bytes are those of the elements in memory.</param>
        private T[] ReadArray<T>(T[] previous, int length, int tag, Func<JsonReader, T> read)
        {
            int count = TypedArray(tag);
            if (count >= 0)
            {
                T[] typed = Trimmed(Room(previous, count), count, length);
                int bytes = Buffer.ByteLength(typed);
                Buffer.BlockCopy(_buffer, _position, typed, 0, bytes);
                _position += bytes;
                return typed;
            }
            BeginArray();
            T[] values = Room(previous, CountAhead());
            for (count = 0; NextElement(); count++)
            {
                if (count == values.Length)
                {
                    Array.Resize(ref values, Math.Max(4, 2 * count));
                }
                values[count] = read(this);
            }
            return Trimmed(values, count, length);
        }

        /// <summary>Enters and leaves a typed array. The caller passes over its bytes, which come next.</summary>
        /// <returns>How many elements it has. -1 if no such array comes next, as in JSON.</returns>
        private protected virtual int TypedArray(int tag) => -1;

        /// <summary>
        /// Counts the elements of the array that was entered, by their commas. The count is right for numbers,
        /// a first guess for texts with commas, and never more than the bytes that are there.
        /// </summary>
        private protected virtual int CountAhead()
        {
            SkipSpace();
            byte[] buffer = _buffer;
            int end = _end;
            int commas = 0;
            int at = _position;
            for (; at < end && buffer[at] != (byte)']'; at++)
            {
                commas += buffer[at] == (byte)',' ? 1 : 0;
            }
            return at == _position ? 0 : commas + 1;
        }

        private static T[] Room<T>(T[] previous, int count) =>
            previous != null && previous.Length == count ? previous
                : count == 0 ? Array.Empty<T>() : new T[count];

        /// <summary>The first elements of an array, which must be of a length, unless that is -1.</summary>
        internal T[] Trimmed<T>(T[] values, int count, int length)
        {
            if (length >= 0 && count != length)
            {
                throw Error("expected " + length + " elements, got " + count);
            }
            if (count == 0)
            {
                return Array.Empty<T>();
            }
            Array.Resize(ref values, count);
            return values;
        }
    }
}
