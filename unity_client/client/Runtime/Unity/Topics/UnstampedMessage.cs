// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;
using System.Linq;
using Ros2Gateway.Json;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// A message as JSON, without the stamps of 0 in its headers: those the gateway sets. An object that Unity
    /// has loaded cannot tell whether someone has set them.
    /// </summary>
    public static class UnstampedMessage
    {
        /// <summary>The content of a message.</summary>
        public static DynamicMessage Of(IMessage message)
        {
            JsonWriter writer = new();
            message.Write(writer);
            return new DynamicMessage(message.RosType) { Value = Unstamped(JsonValue.Parse(writer.ToString())) };
        }

        private static JsonValue Unstamped(JsonValue value)
        {
            if (value.Kind == JsonKind.Array)
            {
                return JsonValue.Array(value.Items.Select(Unstamped).ToArray());
            }
            if (value.Kind != JsonKind.Object)
            {
                return value;
            }
            bool isHeader = value["stamp"].Exists && value["frame_id"].Exists;
            List<KeyValuePair<string, JsonValue>> members = new();
            foreach (string name in value.Names)
            {
                JsonValue member = value[name];
                if (!isHeader || name != "stamp" || member["sec"].AsLong() != 0 || member["nanosec"].AsLong() != 0)
                {
                    members.Add(new KeyValuePair<string, JsonValue>(name, Unstamped(member)));
                }
            }
            return JsonValue.Object(members);
        }
    }
}
