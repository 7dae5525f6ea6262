// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Json;

namespace Ros2Gateway.Tests
{
    /// <summary>The messages of test_msgs/action/Fibonacci, an action that every ROS installation can have.</summary>
    internal sealed class FibonacciGoal : IMessage
    {
        public int order;

        public string RosType => "test_msgs/action/Fibonacci_Goal";

        public void Read(JsonReader reader) => order = (int)JsonValue.Read(reader)["order"].AsLong();

        public void Write(JsonWriter writer)
        {
            writer.BeginObject();
            writer.Name("order");
            writer.Value(order);
            writer.EndObject();
        }
    }

    /// <summary>Result and feedback are alike.</summary>
    internal sealed class FibonacciSequence : IMessage
    {
        private static readonly JsonMembers Members = new("sequence");

        public int[] sequence = new int[0];

        public string RosType => "test_msgs/action/Fibonacci_Result";

        public void Read(JsonReader reader)
        {
            reader.BeginObject();
            int member = JsonMembers.Unknown;
            while (reader.NextMember(Members, ref member))
            {
                if (member == 0)
                {
                    sequence = reader.ReadInt32s();
                }
                else
                {
                    reader.Skip();
                }
            }
        }

        public void Write(JsonWriter writer)
        {
            writer.BeginObject();
            writer.Name("sequence");
            writer.Values(sequence);
            writer.EndObject();
        }
    }
}
