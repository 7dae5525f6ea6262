// SPDX-License-Identifier: Apache-2.0
using System.Text.RegularExpressions;
using Ros2Gateway.Messages;

namespace Ros2Gateway.Editor
{
    /// <summary>The problem of a topic or its type, in words, or null.</summary>
    public static class TopicCheck
    {
        private static readonly Regex Name =
            new(@"^/?[A-Za-z_]\w*(/[A-Za-z_]\w*)*$", RegexOptions.ECMAScript);
        private static readonly Regex Type =
            new(@"^[a-z]\w*/(msg/)?[A-Z][A-Za-z0-9]*$", RegexOptions.ECMAScript);

        /// <summary>Of a topic's name.</summary>
        public static string OfTopic(string topic)
        {
            if (string.IsNullOrEmpty(topic))
            {
                return "no topic is chosen";
            }
            return Name.IsMatch(topic)
                ? null
                : "'" + topic
                    + "' is not a topic name: use letters, digits, _ and /, with no digit first";
        }

        /// <summary>Of a type. *mayBeEmpty* where the gateway finds it out.</summary>
        public static string OfType(string type, bool mayBeEmpty)
        {
            if (string.IsNullOrEmpty(type))
            {
                return mayBeEmpty ? null : "a publisher needs a type";
            }
            if (MessageClasses.Create(type) != null)
            {
                return null;
            }
            if (type[0] >= '0' && type[0] <= '9')
            {
                int last = new TypeCatalogue().Count - 1;
                return "there is no message type with the number " + type + ": use at most " + last;
            }
            return Type.IsMatch(type)
                ? type + " has no class here, so messages are trees (DynamicMessage)"
                : "'" + type + "' is not a type: use pkg/msg/Name, or the number of a message type";
        }

        /// <summary>Of a type, given what the topic carries now. Empty if that is not known.</summary>
        public static string OfGraph(string topic, string type, string carried)
        {
            string chosen = MessageCatalogue.Resolve(type);
            return string.IsNullOrEmpty(chosen) || string.IsNullOrEmpty(carried) || chosen == carried
                ? null
                : topic + " carries " + carried + " now";
        }
    }
}
