// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;

namespace Ros2Gateway.Messages
{
    /// <summary>
    /// The classes of messages by the names of their types: those that were registered, and those that come with
    /// the package. Any thread.
    /// </summary>
    /// <remarks>
    /// Makes the messages that a scene names by text, so this class, like the classes that it lists, is one per process.
    /// A build in which nobody calls <see cref="Create"/> has only the package's classes that its code uses. The
    /// components for any topic call it. With the scripting define <c>ROS2GATEWAY_REGISTERED_MESSAGES</c> they
    /// also know only registered classes.
    /// </remarks>
    public static class MessageCatalogue
    {
        private static readonly object Gate = new object();

        // Replaced, never changed: read without a lock for each message.
        private static volatile Dictionary<string, Func<IMessage>> _registered =
            new Dictionary<string, Func<IMessage>>(StringComparer.Ordinal);

        /// <summary>
        /// The types of messages as <c>pkg/msg/Name</c>, sorted. Parts of services and actions,
        /// which no topic carries, are not among them.
        /// </summary>
        public static IReadOnlyList<string> Types
        {
            get
            {
                SortedSet<string> names = new SortedSet<string>(StringComparer.Ordinal);
#if !ROS2GATEWAY_REGISTERED_MESSAGES
                names.UnionWith(MessageTable.Names);
#endif
                foreach (string type in _registered.Keys)
                {
                    if (type.Contains("/msg/"))
                    {
                        names.Add(type);
                    }
                }
                return new List<string>(names);
            }
        }

        /// <summary>
        /// Makes a class known: to the components for any topic, the editor's menus and <see cref="Create"/>. It
        /// takes the place of the package's class of that type. The first that is registered stays.
        /// </summary>
        /// <param name="type"><c>pkg/msg/Name</c>, or a part: <c>pkg/srv/Name_Request</c>.</param>
        /// <param name="create">Makes a message with the defaults of its definition. Any thread may call it.</param>
        public static void Register(string type, Func<IMessage> create)
        {
            if (string.IsNullOrEmpty(type))
            {
                throw new ArgumentException("a type is missing, such as pkg/msg/Name", "type");
            }
            if (create == null)
            {
                throw new ArgumentNullException("create");
            }
            lock (Gate)
            {
                if (!_registered.ContainsKey(type))
                {
                    _registered = new Dictionary<string, Func<IMessage>>(_registered, StringComparer.Ordinal)
                    {
                        { type, create },
                    };
                }
            }
        }

        /// <summary>Makes a message with the defaults of its definition.</summary>
        /// <param name="typeOrNumber"><c>pkg/msg/Name</c>, <c>pkg/Name</c>, a number of the message
        /// table as text, or a part: <c>pkg/srv/Name_Request</c>.</param>
        /// <returns>Null if there is no class for it.</returns>
        public static IMessage Create(string typeOrNumber)
        {
            string type = Resolve(typeOrNumber);
            if (type == null)
            {
                return null;
            }
            Func<IMessage> create;
            if (_registered.TryGetValue(type, out create))
            {
                return create();
            }
#if ROS2GATEWAY_REGISTERED_MESSAGES
            return null;
#else
            return MessageTable.Create(type);
#endif
        }

        /// <summary>
        /// Returns the full name of a type for what <see cref="Create"/> takes, also of an unknown
        /// type. Null for a number that the table has not.
        /// </summary>
        public static string Resolve(string typeOrNumber)
        {
            if (string.IsNullOrEmpty(typeOrNumber))
            {
                return null;
            }
            if (typeOrNumber[0] >= '0' && typeOrNumber[0] <= '9')
            {
                return MessageTable.OfNumber(typeOrNumber);
            }
            int slash = typeOrNumber.IndexOf('/');
            bool isShort = slash > 0 && slash == typeOrNumber.LastIndexOf('/');
            return isShort ? typeOrNumber.Insert(slash, "/msg") : typeOrNumber;
        }
    }
}
