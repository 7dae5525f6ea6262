// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using Ros2Gateway.Messages;
using UnityEditor;

namespace Ros2Gateway.Editor
{
    /// <summary>All classes of messages in the project, registered or not.</summary>
    public static class MessageClasses
    {
        private static Dictionary<string, Type> _byName;

        /// <summary>Makes a message. Null if no class has the type.</summary>
        /// <param name="typeOrNumber">As for <see cref="MessageCatalogue.Create"/>.</param>
        public static IMessage Create(string typeOrNumber)
        {
            string name = MessageCatalogue.Resolve(typeOrNumber) ?? "";
            return MessageCatalogue.Create(name)
                ?? (All.TryGetValue(name, out Type type) ? (IMessage)Activator.CreateInstance(type) : null);
        }

        private static Dictionary<string, Type> All
        {
            get
            {
                if (_byName != null)
                {
                    return _byName;
                }
                _byName = new Dictionary<string, Type>(StringComparer.Ordinal);
                foreach (Type type in TypeCache.GetTypesDerivedFrom<IMessage>())
                {
                    // others are another form of a message, or cannot be edited
                    if (type.IsSerializable && !type.IsAbstract && type.GetConstructor(Type.EmptyTypes) != null)
                    {
                        string name = ((IMessage)Activator.CreateInstance(type)).RosType;
                        _byName[name] = type;
                    }
                }
                return _byName;
            }
        }
    }
}
