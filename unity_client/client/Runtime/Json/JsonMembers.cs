// SPDX-License-Identifier: Apache-2.0
using System;
using System.Text;

namespace Ros2Gateway.Json
{
    /// <summary>
    /// The names of the members that an object may have, encoded once, so that reading an object compares
    /// bytes and makes no strings. Unchangeable, hence free to share between threads.
    /// </summary>
    public sealed class JsonMembers
    {
        /// <summary>The index of a member that is not among the names.</summary>
        public const int Unknown = -1;

        private readonly byte[][] _names;

        /// <summary>The names in the order in which they are expected. Each is found at its index.</summary>
        public JsonMembers(params string[] names) => _names = Array.ConvertAll(names, Encoding.UTF8.GetBytes);

        /// <summary>Returns the index of a name, <see cref="Unknown"/> if it is not among these.</summary>
        /// <param name="first">The index that is tried first.</param>
        internal int IndexOf(byte[] buffer, int start, int count, int first = 0)
        {
            for (int i = 0; i < _names.Length; i++)
            {
                int index = first + i < _names.Length ? first + i : first + i - _names.Length;
                if (_names[index].Length == count && BeginsAt(_names[index], buffer, start))
                {
                    return index;
                }
            }
            return Unknown;
        }

        /// <summary>
        /// Returns the length of the name at an index if it and a quote come next, else -1.
        /// </summary>
        internal int LengthIfNext(int index, byte[] buffer, int start, int end)
        {
            if (index >= _names.Length)
            {
                return -1;
            }
            byte[] name = _names[index];
            int quote = start + name.Length;
            return quote < end && buffer[quote] == (byte)'"' && BeginsAt(name, buffer, start) ? name.Length : -1;
        }

        private static bool BeginsAt(byte[] name, byte[] buffer, int start)
        {
            for (int i = 0; i < name.Length; i++)
            {
                if (buffer[start + i] != name[i])
                {
                    return false;
                }
            }
            return true;
        }
    }
}
