// SPDX-License-Identifier: Apache-2.0
using System;
using System.Text;

namespace Ros2Gateway.Json
{
    public partial class JsonReader
    {
        /// <summary>So much of a name is in the path of an error.</summary>
        private protected const int LongestNameInPath = 40; // a path is for people. Names are the peer's

        /// <summary>Something else comes next than was asked for.</summary>
        private protected JsonFormatException Unexpected(string expected)
        {
            return Error("expected " + expected + ", got " + DescribeNext());
        }

        /// <summary>An error here.</summary>
        private protected JsonFormatException Error(string reason)
        {
            return new JsonFormatException(reason, Path(), _position);
        }

        internal virtual string DescribeNext()
        {
            if (_position >= _end)
            {
                return "the end";
            }
            byte next = _buffer[_position];
            switch (next)
            {
                case (byte)'{':
                    return "an object";
                case (byte)'[':
                    return "an array";
                case (byte)'"':
                    return "a string";
                default:
                    if (IsDigit(next) || next == (byte)'-')
                    {
                        return "a number";
                    }
                    if (IsLiteralNext("true") || IsLiteralNext("false"))
                    {
                        return "a boolean";
                    }
                    if (IsLiteralNext("null"))
                    {
                        return "null";
                    }
                    return next > 0x20 && next < 0x7F ? "'" + (char)next + "'" : "the byte " + next;
            }
        }

        internal virtual string Path()
        {
            var path = new StringBuilder();
            for (int i = 1; i <= _depth; i++)
            {
                Level level = _levels[i];
                if (level.IsArray)
                {
                    if (level.Index >= 0)
                    {
                        path.Append('[').Append(level.Index).Append(']');
                    }
                }
                else if (level.NameLength > 0)
                {
                    path.Append(path.Length == 0 ? "" : ".");
                    int length = Math.Min(level.NameLength, LongestNameInPath);
                    path.Append(Encoding.UTF8.GetString(_buffer, level.NameStart, length));
                }
            }
            return path.ToString();
        }
    }
}
