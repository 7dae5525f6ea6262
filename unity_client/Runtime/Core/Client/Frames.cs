// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>How operations are written: an object with op, mostly an id, and members.</summary>
    internal static class Frames
    {
        /// <summary>Begins an operation. EndObject ends it.</summary>
        internal static void Begin(this JsonWriter frame, string op, string id = null)
        {
            frame.BeginObject();
            frame.Member("op", op);
            if (id != null)
            {
                frame.Member("id", id);
            }
        }

        internal static void Member(this JsonWriter frame, string name, string value)
        {
            frame.Name(name);
            frame.Value(value);
        }

        internal static void Member(this JsonWriter frame, string name, bool value)
        {
            frame.Name(name);
            frame.Value(value);
        }

        internal static void Member(this JsonWriter frame, string name, int value)
        {
            frame.Name(name);
            frame.Value(value);
        }

        internal static void Member(this JsonWriter frame, string name, long value)
        {
            frame.Name(name);
            frame.Value(value);
        }

        internal static void Member(this JsonWriter frame, string name, double value)
        {
            frame.Name(name);
            frame.Value(value);
        }
    }
}
