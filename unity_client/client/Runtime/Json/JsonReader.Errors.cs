// SPDX-License-Identifier: Apache-2.0
using System;
using System.Text;

namespace Ros2Gateway.Json
{
    public partial class JsonReader
    {
        /// <summary>So much of a name is in the path of an error.</summary>
        private protected const int LongestNameInPath = 40; // a path is for people. Names are the peer's

        // By kind
        private static readonly string[] Words =
            { "an object", "an array", "a string", "a number", "a boolean", "null", "the end" };

        /// <summary>Something else comes next than was asked for.</summary>
        private protected JsonFormatException Unexpected(string expected)
        {
            JsonKind? next = Next();
            byte first = next == JsonKind.End ? (byte)0 : _buffer[_position];
            string got = next.HasValue ? Words[(int)next.Value]
                : first > 0x20 && first < 0x7F ? "'" + (char)first + "'" : "the byte " + first;
            return Error("expected " + expected + ", got " + got);
        }

        /// <summary>An error here.</summary>
        private protected JsonFormatException Error(string reason)
        {
            var path = new StringBuilder();
            for (int i = 1; i <= _depth; i++)
            {
                Level level = _levels[i];
                if (level.IsArray && level.Index >= 0)
                {
                    path.Append('[').Append(level.Index).Append(']');
                }
                else if (!level.IsArray && level.NameLength > 0)
                {
                    int length = Math.Min(level.NameLength, LongestNameInPath);
                    path.Append(path.Length == 0 ? "" : ".");
                    path.Append(Encoding.UTF8.GetString(_buffer, level.NameStart, length));
                }
            }
            return new JsonFormatException(reason, path.ToString(), _position);
        }
    }
}
