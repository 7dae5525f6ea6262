// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Json;

namespace Ros2Gateway.Messages
{
    /// <summary>The common part of generated messages that nest others.</summary>
    public static class NestedMessages
    {
        /// <summary>Makes an array of new messages: a field of fixed length has no null in it.</summary>
        public static T[] Make<T>(int length, Func<T> create)
            where T : class, IMessage
        {
            var messages = new T[length];
            for (int i = 0; i < length; i++)
            {
                messages[i] = create();
            }
            return messages;
        }

        /// <summary>Reads an array of messages.</summary>
        /// <param name="previous">The array to fill again, with what is in it, if it has the right length.</param>
        /// <param name="reader">Before the array.</param>
        /// <param name="create">Makes an empty message. A delegate, because <c>new T()</c> is
        /// reflection.</param>
        /// <param name="length">How many there must be. -1 takes any number.</param>
        public static T[] Read<T>(T[] previous, JsonReader reader, Func<T> create, int length = -1)
            where T : class, IMessage
        {
            T[] messages = previous ?? Array.Empty<T>();
            int count = 0;
            reader.BeginArray();
            for (; reader.NextElement(); count++)
            {
                if (count == messages.Length)
                {
                    Array.Resize(ref messages, Math.Max(4, 2 * count));
                }
                (messages[count] ??= create()).Read(reader);
            }
            return reader.Trimmed(messages, count, length);
        }

        /// <summary>Writes a message. Null as one of which every field has its default.</summary>
        public static void Write<T>(JsonWriter writer, T message)
            where T : class, IMessage
        {
            if (message == null)
            {
                writer.BeginObject();
                writer.EndObject();
                return;
            }
            message.Write(writer);
        }

        /// <summary>Writes an array of messages. Null as the empty array.</summary>
        public static void Write<T>(JsonWriter writer, T[] messages)
            where T : class, IMessage
        {
            writer.BeginArray();
            for (int i = 0; messages != null && i < messages.Length; i++)
            {
                Write(writer, messages[i]);
            }
            writer.EndArray();
        }

        /// <summary>Makes sure that an array has the length that its type demands. Null has none.</summary>
        /// <exception cref="InvalidOperationException">It has another.</exception>
        public static void CheckLength(Array array, string field, int length)
        {
            int actual = array == null ? 0 : array.Length;
            if (actual != length)
            {
                throw new InvalidOperationException(
                    field + " has " + actual + " elements, must have " + length);
            }
        }
    }
}
