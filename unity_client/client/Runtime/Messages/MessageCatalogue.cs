// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Linq;

namespace Ros2Gateway.Messages
{
    /// <summary>
    /// The classes of messages that are known by the names of their types. Any thread.
    /// </summary>
    /// <remarks>
    /// A scene names types by text. A class is known once it is registered: by a display of that type, by
    /// generated assemblies, or by <see cref="Register{T}"/>. So a build has only the classes that its code uses.
    /// Messages of other types are trees. <c>Subscribe&lt;T&gt;</c> of the client needs no registration.
    /// </remarks>
    public static class MessageCatalogue
    {
        private static readonly object Gate = new();

        // Replaced, never changed: read without a lock for each message.
        private static volatile Dictionary<string, Func<IMessage>> _registered = new(StringComparer.Ordinal);

        /// <summary>
        /// The types of messages as <c>pkg/msg/Name</c>, sorted: those whose classes come with the package, and those
        /// that are registered. Parts of services and actions, which no topic carries, are not among them.
        /// </summary>
        public static IReadOnlyList<string> Types =>
            MessageTable.Names.Union(_registered.Keys.Where(type => type.Contains("/msg/")))
                .OrderBy(type => type, StringComparer.Ordinal).ToArray();

        /// <summary>
        /// Makes a class known: to the components for any topic, the editor's menus and <see cref="Create"/>. The
        /// first class that is registered for a type stays.
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

        /// <summary>Makes a class known, like the other.</summary>
        public static void Register<T>()
            where T : IMessage, new()
        {
            string type = new T().RosType;
            if (type.Length > 0 && !_registered.ContainsKey(type)) // a tree has no type
            {
                Register(type, () => new T());
            }
        }

        /// <summary>Makes a message with the defaults of its definition.</summary>
        /// <param name="typeOrNumber"><c>pkg/msg/Name</c>, <c>pkg/Name</c>, a number of the message
        /// table as text, or a part: <c>pkg/srv/Name_Request</c>.</param>
        /// <returns>Null if no class is registered for it.</returns>
        public static IMessage Create(string typeOrNumber)
        {
            string type = Resolve(typeOrNumber);
            return type != null && _registered.TryGetValue(type, out Func<IMessage> create) ? create() : null;
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
