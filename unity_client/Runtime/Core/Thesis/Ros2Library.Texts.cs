// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Messages.StdMsgs;

namespace Ros2Gateway.Thesis
{
    /// <content>Strings and headers.</content>
    public static partial class Ros2Library
    {
        /// <summary>Sends a text.</summary>
        public static bool send_string(string topic, string msg)
        {
            return send(topic, new StringMsg { data = msg ?? "" });
        }

        /// <summary>Sends a header. A stamp of 0 arrives as 0.</summary>
        public static bool send_header(string topic, uint sec, uint nanosec, string frame_id)
        {
            HeaderMsg header = new HeaderMsg();
            return Stamp("send_header", topic, header, sec, nanosec, frame_id) && send(topic, header);
        }

        /// <summary>Sends a header. Without a stamp it gets the time at which it arrives.</summary>
        public static bool send_header(string topic, HeaderMsg header)
        {
            return send(topic, header);
        }

        /// <summary>Takes the oldest unread text.</summary>
        /// <param name="buffer">A StringBuilder or a byte array.</param>
        /// <param name="size">How many bytes it takes. Becomes how many were written, 0 if there is no text.</param>
        /// <returns>False without a message, or if it does not fit: then it stays, and a debug message says why.</returns>
        public static bool poll_string(string topic, TextBuffer buffer, ref uint size)
        {
            lock (Gate)
            {
                StringMsg message;
                if (!Oldest("poll_string", topic, out message)
                    || !Fits("poll_string", topic, "buffer", buffer, size, message.data))
                {
                    size = 0;
                    return false;
                }
                size = buffer.Write(message.data);
                return Taken(topic, message);
            }
        }

        /// <inheritdoc cref="poll_string(string, TextBuffer, ref uint)"/>
        public static bool poll_string(string topic, TextBuffer buffer, ref int size)
        {
            uint bytes = Unsigned(size);
            bool isThere = poll_string(topic, buffer, ref bytes);
            size = (int)bytes;
            return isThere;
        }

        /// <summary>Takes the oldest unread text.</summary>
        public static bool poll_string(string topic, out string text)
        {
            StringMsg message;
            bool isThere = Poll("poll_string", topic, out message);
            text = isThere ? message.data : "";
            return isThere;
        }

        /// <summary>Takes the oldest unread header.</summary>
        /// <param name="frame_id_size">How many bytes fit. Becomes how many were written, 0 if there is no header.</param>
        /// <returns>False without a message, or if it does not fit: then it stays, and a debug message says why.</returns>
        public static bool poll_header(
            string topic, ref uint sec, ref uint nanosec, TextBuffer frame_id, ref uint frame_id_size)
        {
            lock (Gate)
            {
                HeaderMsg header;
                if (!Oldest("poll_header", topic, out header)
                    || !Fits("poll_header", topic, "frame_id", frame_id, frame_id_size, header.frame_id))
                {
                    frame_id_size = 0;
                    return false;
                }
                Put(header, ref sec, ref nanosec, frame_id, ref frame_id_size);
                return Taken(topic, header);
            }
        }

        /// <inheritdoc cref="poll_header(string, ref uint, ref uint, TextBuffer, ref uint)"/>
        public static bool poll_header(
            string topic, ref uint sec, ref uint nanosec, TextBuffer frame_id, ref int frame_id_size)
        {
            uint bytes = Unsigned(frame_id_size);
            bool isThere = poll_header(topic, ref sec, ref nanosec, frame_id, ref bytes);
            frame_id_size = (int)bytes;
            return isThere;
        }

        /// <summary>Takes the oldest unread header.</summary>
        public static bool poll_header(string topic, out HeaderMsg header)
        {
            return Poll("poll_header", topic, out header);
        }
    }
}
