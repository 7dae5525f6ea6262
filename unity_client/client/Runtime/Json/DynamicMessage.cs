// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>A message of any type, as a tree: for types that have no class.</summary>
    public sealed class DynamicMessage : IMessage
    {
        private readonly string _type;

        /// <summary>A message of a type that the gateway finds out, from its topic, service or action.</summary>
        public DynamicMessage()
            : this("")
        {
        }

        /// <param name="type">pkg/msg/Name. May be empty where it is only read.</param>
        public DynamicMessage(string type)
        {
            _type = type;
            Value = JsonValue.Object();
        }

        /// <inheritdoc/>
        public string RosType => _type;

        /// <summary>The fields.</summary>
        public JsonValue Value { get; set; }

        /// <inheritdoc/>
        public void Read(JsonReader reader) => Value = JsonValue.Read(reader);

        /// <inheritdoc/>
        public void Write(JsonWriter writer) => Value.Write(writer);
    }
}
