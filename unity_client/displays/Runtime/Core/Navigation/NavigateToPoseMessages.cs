// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Json;
using Ros2Gateway.Messages;
using Ros2Gateway.Messages.BuiltinInterfaces;
using Ros2Gateway.Messages.GeometryMsgs;

namespace Ros2Gateway.Navigation
{
    /// <summary>
    /// The goal of nav2_msgs/action/NavigateToPose. These three classes have the fields that all versions of Nav2
    /// share, and are not in the namespace where those lie that are generated for one robot.
    /// </summary>
    public sealed class NavigateToPoseGoal : IMessage
    {
        private static readonly JsonMembers Members = new("pose", "behavior_tree");

        /// <summary>Where to go, in any frame that the robot can transform.</summary>
        public PoseStampedMsg pose = new();

        /// <summary>The behaviour tree to use, as a path on the robot. Empty for the usual one.</summary>
        public string behavior_tree = "";

        /// <inheritdoc/>
        public string RosType => "nav2_msgs/action/NavigateToPose_Goal";

        /// <inheritdoc/>
        public void Read(JsonReader reader)
        {
            reader.BeginObject();
            int member = JsonMembers.Unknown;
            while (reader.NextMember(Members, ref member))
            {
                switch (member)
                {
                    case 0:
                        pose.Read(reader);
                        break;
                    case 1:
                        behavior_tree = reader.ReadString();
                        break;
                    default:
                        reader.Skip();
                        break;
                }
            }
        }

        /// <inheritdoc/>
        public void Write(JsonWriter writer)
        {
            writer.BeginObject();
            writer.Name("pose");
            NestedMessages.Write(writer, pose);
            writer.Name("behavior_tree");
            writer.Value(behavior_tree ?? "");
            writer.EndObject();
        }
    }

    /// <summary>The feedback of nav2_msgs/action/NavigateToPose.</summary>
    public sealed class NavigateToPoseFeedback : IMessage
    {
        private static readonly JsonMembers Members = new(
            "current_pose", "navigation_time", "estimated_time_remaining", "number_of_recoveries", "distance_remaining");

        /// <summary>The place of the robot.</summary>
        public PoseStampedMsg current_pose = new();

        /// <summary>How long it has been on its way.</summary>
        public DurationMsg navigation_time = new();

        /// <summary>How long it will take.</summary>
        public DurationMsg estimated_time_remaining = new();

        /// <summary>How often it was stuck and tried something else.</summary>
        public short number_of_recoveries;

        /// <summary>The rest of the way, in metres.</summary>
        public float distance_remaining;

        /// <inheritdoc/>
        public string RosType => "nav2_msgs/action/NavigateToPose_Feedback";

        /// <inheritdoc/>
        public void Read(JsonReader reader)
        {
            reader.BeginObject();
            int member = JsonMembers.Unknown;
            while (reader.NextMember(Members, ref member))
            {
                switch (member)
                {
                    case 0:
                        current_pose.Read(reader);
                        break;
                    case 1:
                        navigation_time.Read(reader);
                        break;
                    case 2:
                        estimated_time_remaining.Read(reader);
                        break;
                    case 3:
                        number_of_recoveries = reader.ReadInt16();
                        break;
                    case 4:
                        distance_remaining = reader.ReadFloat32();
                        break;
                    default:
                        reader.Skip();
                        break;
                }
            }
        }

        /// <inheritdoc/>
        public void Write(JsonWriter writer)
        {
            writer.BeginObject();
            writer.Name("current_pose");
            NestedMessages.Write(writer, current_pose);
            writer.Name("navigation_time");
            NestedMessages.Write(writer, navigation_time);
            writer.Name("estimated_time_remaining");
            NestedMessages.Write(writer, estimated_time_remaining);
            writer.Name("number_of_recoveries");
            writer.Value(number_of_recoveries);
            writer.Name("distance_remaining");
            writer.Value(distance_remaining);
            writer.EndObject();
        }
    }

    /// <summary>How nav2_msgs/action/NavigateToPose ends. Before Jazzy it says nothing.</summary>
    public sealed class NavigateToPoseResult : IMessage
    {
        private static readonly JsonMembers Members = new("error_code", "error_msg");

        /// <summary>0 for none. Others are those of Nav2's planner and controller.</summary>
        public ushort error_code;

        /// <summary>The error, in Nav2's words, from Kilted on.</summary>
        public string error_msg = "";

        /// <inheritdoc/>
        public string RosType => "nav2_msgs/action/NavigateToPose_Result";

        /// <inheritdoc/>
        public void Read(JsonReader reader)
        {
            reader.BeginObject();
            int member = JsonMembers.Unknown;
            while (reader.NextMember(Members, ref member))
            {
                switch (member)
                {
                    case 0:
                        error_code = reader.Kind == JsonKind.Number ? reader.ReadUInt16() : Skipped(reader);
                        break;
                    case 1:
                        error_msg = reader.ReadString();
                        break;
                    default:
                        reader.Skip();
                        break;
                }
            }
        }

        /// <inheritdoc/>
        public void Write(JsonWriter writer)
        {
            writer.BeginObject();
            writer.Name("error_code");
            writer.Value(error_code);
            writer.Name("error_msg");
            writer.Value(error_msg ?? "");
            writer.EndObject();
        }

        private static ushort Skipped(JsonReader reader)
        {
            reader.Skip();
            return 0;
        }
    }
}
