// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Messages.StdMsgs;

namespace Ros2Gateway.Thesis
{
    /// <content>Strings and headers.</content>
    public static partial class Ros2Library
    {
        /// <summary>Sends a text.</summary>
        public static bool send_string(string topic, string msg) => send(topic, new StringMsg { data = msg ?? "" });

        /// <summary>Sends a header. A stamp of 0 arrives as 0.</summary>
        public static bool send_header(string topic, uint sec, uint nanosec, string frame_id)
        {
            HeaderMsg header = new();
            return Stamp("send_header", topic, header, sec, nanosec, frame_id) && send(topic, header);
        }

        /// <summary>Takes the oldest unread text.</summary>
        /// <param name="buffer">A StringBuilder or a byte array.</param>
        /// <param name="size">
        /// How many bytes it takes. Becomes how many were written, 0 if there is no text. Here and below, a size is
        /// uint, int, ulong or UIntPtr: what a program declared for the size_t* of the library.
        /// </param>
        public static bool poll_string<TSize>(string topic, TextBuffer buffer, ref TSize size)
            where TSize : struct
        {
            lock (Gate)
            {
                if (!Oldest("poll_string", topic, out StringMsg message))
                {
                    size = default(TSize);
                    return false;
                }
                Put("poll_string", topic, "buffer", message.data, buffer, ref size);
                return Taken(topic, message);
            }
        }

        /// <summary>Takes the oldest unread header.</summary>
        /// <param name="frame_id_size">How many bytes fit. Becomes how many were written, 0 if there is no header.</param>
        public static bool poll_header<TSize>(
            string topic, ref uint sec, ref uint nanosec, TextBuffer frame_id, ref TSize frame_id_size)
            where TSize : struct
        {
            lock (Gate)
            {
                if (!Oldest("poll_header", topic, out HeaderMsg header))
                {
                    frame_id_size = default(TSize);
                    return false;
                }
                Put("poll_header", topic, header, ref sec, ref nanosec, frame_id, ref frame_id_size);
                return Taken(topic, header);
            }
        }
    }
}
