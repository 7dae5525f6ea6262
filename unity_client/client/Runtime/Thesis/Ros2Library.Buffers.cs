// SPDX-License-Identifier: Apache-2.0
using System;
using System.Text;
using Ros2Gateway.Messages.BuiltinInterfaces;
using Ros2Gateway.Messages.StdMsgs;

namespace Ros2Gateway.Thesis
{
    /// <content>
    /// Messages in the caller's buffers. A text that does not fit is cut, as in 2021. An array that does not fit
    /// leaves the message where it is.
    /// </content>
    public static partial class Ros2Library
    {
        // If a sender fills in a header.
        private static bool Stamp(
            string call, string topic, HeaderMsg header, uint sec, uint nanosec, string frame_id)
        {
            if (sec > int.MaxValue)
            {
                lock (Gate)
                {
                    return Failed(call, topic, "sec is " + sec + ", at most " + int.MaxValue + " in ROS");
                }
            }
            header.stamp = new TimeMsg { sec = (int)sec, nanosec = nanosec }; // also one of 0
            header.frame_id = frame_id ?? "";
            return true;
        }

        private static void Put<T>(
            string call, string topic, HeaderMsg header, ref uint sec, ref uint nanosec, TextBuffer frame_id,
            ref T frame_id_size)
            where T : struct
        {
            sec = unchecked((uint)header.stamp.sec); // as it was in C: before 1970 it wraps
            nanosec = header.stamp.nanosec;
            Put(call, topic, "frame_id", header.frame_id, frame_id, ref frame_id_size);
        }

        private static void Put<T>(
            string call, string topic, string part, string text, TextBuffer buffer, ref T size)
            where T : struct
        {
            int bytes = Encoding.UTF8.GetByteCount(text);
            int written = buffer.Write(text, Count(size));
            size = Size<T>(written);
            if (written < bytes)
            {
                Failed(call, topic, part + " got " + written + " of " + bytes + " bytes: the text is cut, pass a larger buffer");
            }
        }

        private static bool Fits<T>(string call, string topic, string part, Array buffer, T size, int count)
            where T : struct
        {
            int capacity = buffer == null ? 0 : Math.Min(Count(size), buffer.Length);
            return count <= capacity
                || Failed(call, topic, part + " needs " + count + " elements, has " + capacity + ": the message stays, pass a larger buffer");
        }

        private static void Copy<T, TSize>(T[] from, T[] to, out TSize size)
            where TSize : struct
        {
            if (from.Length > 0)
            {
                Array.Copy(from, to, from.Length);
            }
            size = Size<TSize>(from.Length);
        }

        // The declared type of a size_t*. Another type has room for nothing.
        private static int Count<T>(T size)
            where T : struct
        {
            ulong count = size switch
            {
                uint number => number,
                int number => (ulong)Math.Max(0, number),
                ulong number => number,
                UIntPtr number => number.ToUInt64(),
                _ => 0,
            };
            return (int)Math.Min(count, int.MaxValue);
        }

        private static T Size<T>(int count)
            where T : struct
        {
            object value = typeof(T) == typeof(uint) ? (object)(uint)count
                : typeof(T) == typeof(int) ? (object)count
                : typeof(T) == typeof(ulong) ? (object)(ulong)count
                : new UIntPtr((uint)count);
            return value is T ? (T)value : default(T);
        }

        private static uint Unsigned(int size) => size > 0 ? (uint)size : 0;
    }
}
