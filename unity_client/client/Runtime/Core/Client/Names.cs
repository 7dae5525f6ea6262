// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>Names of topics, services and actions, and of their types.</summary>
    internal static class Names
    {
        /// <summary>With a leading slash: what the gateway sends carries names exactly as they were written.</summary>
        internal static string Absolute(string name) => string.IsNullOrEmpty(name) || name[0] == '/' ? name ?? "" : "/" + name;

        /// <summary>
        /// Writes a request or a goal, and the type that it belongs to. The gateway then carries out nothing of a service
        /// or an action of another type, which would take fields that it does not find for zero.
        /// </summary>
        /// <param name="what">"request" or "goal".</param>
        /// <param name="suffix">The end of the message's own type name: "_Request".</param>
        internal static void WriteArguments(JsonWriter frame, IMessage message, string what, string typeMember, string suffix)
        {
            if (message == null)
            {
                throw new ArgumentException("the " + what + " is null: pass a message");
            }
            string type = message.RosType ?? "";
            if (type.Length > 0) // else it is dynamic, and the gateway finds the type out
            {
                frame.Name(typeMember).Value(
                    type.EndsWith(suffix, StringComparison.Ordinal) ? type.Substring(0, type.Length - suffix.Length) : type);
            }
            frame.Name("args");
            message.Write(frame);
        }
    }
}
