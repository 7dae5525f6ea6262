// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway.Json
{
    /// <summary>
    /// Bytes are not JSON (or no CBOR, where that was asked for), or hold another value than was asked for. The message says where and why:
    /// <c>pose.position.x: expected a number, got a string (byte 117)</c>.
    /// </summary>
    public sealed class JsonFormatException : Exception
    {
        /// <summary>Makes the message out of its parts.</summary>
        public JsonFormatException(string reason, string path, int position)
            : base((path.Length == 0 ? reason : path + ": " + reason) + " (byte " + position + ")")
        {
            Path = path;
            Position = position;
        }

        /// <summary>The member that is wrong (<c>poses[3].x</c>), empty at the top.</summary>
        public string Path { get; }

        /// <summary>The place in the buffer where reading stopped, in bytes from its start.</summary>
        public int Position { get; }
    }
}
