// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Messages.BuiltinInterfaces;
using Ros2Gateway.Messages.StdMsgs;

namespace Ros2Gateway.Thesis
{
    /// <content>
    /// Messages in the caller's buffers: all of a message or nothing, and what does not fit stays where it is.
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

        private static void Put(
            HeaderMsg header, ref uint sec, ref uint nanosec, TextBuffer frame_id, ref uint frame_id_size)
        {
            sec = unchecked((uint)header.stamp.sec); // as it was in C: before 1970 it wraps
            nanosec = header.stamp.nanosec;
            frame_id_size = frame_id.Write(header.frame_id);
        }

        private static bool Fits(string call, string topic, string part, TextBuffer buffer, uint size, string text)
        {
            uint bytes = TextBuffer.Bytes(text);
            uint capacity = buffer.Capacity(size);
            return bytes <= capacity
                || Failed(call, topic, part + " needs " + bytes + " bytes, has " + capacity + ": the message stays, pass a larger buffer");
        }

        private static bool Fits(string call, string topic, string part, Array buffer, uint size, long count)
        {
            long capacity = buffer == null ? 0 : Math.Min(size, buffer.LongLength);
            return count <= capacity
                || Failed(call, topic, part + " needs " + count + " elements, has " + capacity + ": the message stays, pass a larger buffer");
        }

        private static uint Copied<T>(T[] from, T[] to)
        {
            if (from.Length > 0)
            {
                Array.Copy(from, to, from.Length);
            }
            return (uint)from.Length;
        }

        private static uint Unsigned(int size)
        {
            return size > 0 ? (uint)size : 0;
        }
    }
}
