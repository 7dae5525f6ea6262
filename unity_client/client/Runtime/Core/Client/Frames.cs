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
            frame.Name("op").Value(op);
            if (id != null)
            {
                frame.Name("id").Value(id);
            }
        }
    }
}
