// SPDX-License-Identifier: Apache-2.0
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

        private readonly string[] _names;
        private readonly byte[][] _encoded;

        /// <summary>The names in the order in which they are expected. Each is found at its index.</summary>
        public JsonMembers(params string[] names)
        {
            _names = (string[])names.Clone();
            _encoded = new byte[names.Length][];
            for (int i = 0; i < names.Length; i++)
            {
                _encoded[i] = Encoding.UTF8.GetBytes(names[i]);
            }
        }

        /// <summary>Returns the index of a name, <see cref="Unknown"/> if it is not among these.</summary>
        public int IndexOf(string name)
        {
            for (int i = 0; i < _names.Length; i++)
            {
                if (string.Equals(_names[i], name))
                {
                    return i;
                }
            }
            return Unknown;
        }

        internal int IndexOf(byte[] buffer, int start, int count)
        {
            for (int i = 0; i < _encoded.Length; i++)
            {
                if (_encoded[i].Length == count && BeginsAt(_encoded[i], buffer, start))
                {
                    return i;
                }
            }
            return Unknown;
        }

        /// <summary>
        /// Returns the length of the name at an index if it and a quote come next, else -1.
        /// </summary>
        internal int LengthIfNext(int index, byte[] buffer, int start, int end)
        {
            if (index >= _encoded.Length)
            {
                return -1;
            }
            byte[] name = _encoded[index];
            int quote = start + name.Length;
            bool isNext = quote < end && buffer[quote] == (byte)'"' && BeginsAt(name, buffer, start);
            return isNext ? name.Length : -1;
        }

        /// <summary>Whether the name at an index is these bytes. False if there is no such index.</summary>
        internal bool IsAt(int index, byte[] buffer, int start, int count)
        {
            return index < _encoded.Length && _encoded[index].Length == count
                && BeginsAt(_encoded[index], buffer, start);
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
