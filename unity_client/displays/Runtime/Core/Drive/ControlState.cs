// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>The present motion of a robot, by the gateway.</summary>
    public enum RobotMotion
    {
        /// <summary>Nothing is known.</summary>
        Unknown,

        /// <summary>No command moves it.</summary>
        Stopped,

        /// <summary>The last command was one to move.</summary>
        Moving,

        /// <summary>It is told to stand, several times.</summary>
        Stopping,
    }

    /// <summary>Which client drives a robot.</summary>
    public enum ControlHolder
    {
        /// <summary>None, as far as is known.</summary>
        None,

        /// <summary>This one.</summary>
        You,

        /// <summary>Another one.</summary>
        Other,
    }

    /// <summary>The guard process, which stops a robot if the gateway dies.</summary>
    public enum GuardState
    {
        /// <summary>Nothing is known, or nothing is to be guarded yet.</summary>
        Unknown,

        /// <summary>It is there.</summary>
        Ready,

        /// <summary>It will be there soon: a command to move waits for it, for a moment.</summary>
        Starting,

        /// <summary>It is gone: nothing moves.</summary>
        Lost,
    }

    /// <summary>The driver of a robot, and whether it may be driven, at one moment.</summary>
    public sealed class ControlState
    {
        private readonly string _text;

        /// <summary>The command topic, such as /cmd_vel.</summary>
        public readonly string Topic;

        /// <summary>
        /// Whether the gateway has said anything: not without a connection, nor of a topic that moves no robot.
        /// </summary>
        public readonly bool IsKnown;

        /// <summary>The command that the robot gets.</summary>
        public readonly RobotMotion Motion;

        /// <summary>Whether it was stopped, and stays so until a command of zero is published.</summary>
        public readonly bool IsTripped;

        /// <summary>
        /// Why it was stopped last, for programs: zero, stop, release, deadline, disconnect, takeover, lease,
        /// permission, invalid_value, backlog, guard, shutdown. Empty if it never was.
        /// </summary>
        public readonly string Cause;

        /// <summary>Which client drives.</summary>
        public readonly ControlHolder Holder;

        /// <summary>Whether something stops the robot if the gateway dies.</summary>
        public readonly GuardState Guard;

        /// <summary>After so many seconds without a command the robot is stopped.</summary>
        public readonly double DeadlineSeconds;

        /// <summary>After so many seconds without a command another client may drive.</summary>
        public readonly double LeaseSeconds;

        /// <summary>Why a command to move would be refused, in words. Null if none of this is against it.</summary>
        public readonly string Refusal;

        internal ControlState(string topic, string text)
        {
            Topic = topic;
            Cause = "";
            _text = text;
        }

        private ControlState(string topic, JsonValue frame)
        {
            Topic = topic;
            IsKnown = true;
            Motion = MotionOf(frame["state"].AsString());
            IsTripped = frame["tripped"].AsBool();
            Cause = frame["cause"].AsString();
            Holder = HolderOf(frame["holder"].AsString());
            Guard = GuardOf(frame["guard"].AsString());
            DeadlineSeconds = frame["deadline_s"].AsDouble(0);
            LeaseSeconds = frame["lease_s"].AsDouble(0);
            Refusal = RefusalOf();
            _text = Refusal ?? StatusText();
        }

        /// <summary>The state for people, in a few words.</summary>
        public override string ToString() => _text;

        internal static ControlState Read(JsonValue frame) =>
            new ControlState(Names.Absolute(frame["topic"].AsString()), frame);

        private string RefusalOf()
        {
            if (Guard == GuardState.Lost)
            {
                return "stopped, because the guard process of the gateway is not running: wait, then drive on";
            }
            if (Holder == ControlHolder.Other && Motion == RobotMotion.Moving)
            {
                return "another client drives";
            }
            return IsTripped ? "stopped, " + CauseText() + ": let go (publish zero), then drive on" : null;
        }

        private string StatusText()
        {
            if (Guard == GuardState.Starting)
            {
                return "the guard process of the gateway is starting: wait a moment";
            }
            return Motion switch
            {
                RobotMotion.Moving => "you drive", // another's driving is a refusal
                RobotMotion.Stopping => "stopping",
                _ => Holder switch
                {
                    ControlHolder.You => "you have control",
                    ControlHolder.Other => "another client has control",
                    _ => "nobody drives",
                },
            };
        }

        private string CauseText() =>
            Cause switch
            {
                "zero" => "it was commanded to",
                "stop" => "another client asked for a stop",
                "release" => "control was released",
                "deadline" => "commands stopped arriving",
                "disconnect" => "the client that drove disconnected",
                "takeover" => "another client took control",
                "lease" => "control was not renewed",
                "permission" => "the permission to drive ended",
                "invalid_value" => "a command was invalid",
                "backlog" => "many commands arrived late and at once",
                "guard" => "the gateway's guard process ended or hung",
                "reader" => "another node began to listen, which may be a robot that starts",
                "shutdown" => "the gateway shuts down",
                _ => Cause.Length > 0 ? Cause : "the gateway waits for a zero",
            };

        private static RobotMotion MotionOf(string word) => word switch
        {
            "moving" => RobotMotion.Moving,
            "stopping" => RobotMotion.Stopping,
            "stopped" => RobotMotion.Stopped,
            _ => RobotMotion.Unknown,
        };

        private static ControlHolder HolderOf(string word) => word switch
        {
            "you" => ControlHolder.You,
            "other" => ControlHolder.Other,
            _ => ControlHolder.None,
        };

        private static GuardState GuardOf(string word) => word switch
        {
            "ready" => GuardState.Ready,
            "starting" => GuardState.Starting,
            "lost" => GuardState.Lost,
            _ => GuardState.Unknown,
        };
    }
}
