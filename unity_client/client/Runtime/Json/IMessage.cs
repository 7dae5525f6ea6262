// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>
    /// A ROS message that reads itself from JSON and writes itself, without reflection. The classes of the
    /// list of message types are generated. Your classes work everywhere that they do.
    /// </summary>
    public interface IMessage
    {
        /// <summary>The type as ROS names it: <c>pkg/msg/Name</c>, <c>pkg/srv/Name_Request</c>.</summary>
        string RosType { get; }

        /// <summary>
        /// Takes over what the JSON object that comes next has. Fields that it lacks stay as they are,
        /// members that are not fields are skipped.
        /// </summary>
        /// <exception cref="JsonFormatException">The bytes are not JSON, or a value does not fit its field.
        /// The fields read before it have their new values.</exception>
        void Read(JsonReader reader);

        /// <summary>
        /// Writes all fields as one JSON object. Bounds (<c>string&lt;=5</c>, <c>float64[&lt;=3]</c>) are the
        /// gateway's to check, which says in words what does not fit. Null texts, arrays and messages are
        /// written as empty.
        /// </summary>
        /// <exception cref="System.InvalidOperationException">An array of fixed length has another length.
        /// </exception>
        void Write(JsonWriter writer);
    }
}
