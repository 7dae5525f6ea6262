// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Messages.SensorMsgs;

namespace Ros2Gateway.Thesis
{
    /// <content>Pictures.</content>
    public static partial class Ros2Library
    {
        /// <summary>Takes the oldest unread picture, as pixels.</summary>
        /// <param name="frame_id_size">How many bytes fit. Becomes how many were written, as all sizes.</param>
        /// <returns>False without a message, or if it does not fit: then it stays, and a debug message says why.</returns>
        public static bool poll_image(
            string topic, ref uint sec, ref uint nanosec, TextBuffer frame_id, ref uint frame_id_size,
            ref uint height, ref uint width, TextBuffer encoding, ref uint encoding_size,
            ref byte is_bigendian, ref uint step, byte[] data, ref uint data_size)
        {
            lock (Gate)
            {
                const string Call = "poll_image";
                ImageMsg image;
                if (!Oldest(Call, topic, out image)
                    || !Fits(Call, topic, "frame_id", frame_id, frame_id_size, image.header.frame_id)
                    || !Fits(Call, topic, "encoding", encoding, encoding_size, image.encoding)
                    || !Fits(Call, topic, "data", data, data_size, image.data.Length))
                {
                    frame_id_size = 0;
                    encoding_size = 0;
                    data_size = 0;
                    return false;
                }
                Put(image.header, ref sec, ref nanosec, frame_id, ref frame_id_size);
                height = image.height;
                width = image.width;
                encoding_size = encoding.Write(image.encoding);
                is_bigendian = image.is_bigendian;
                step = image.step;
                data_size = Copied(image.data, data);
                return Taken(topic, image);
            }
        }

        /// <inheritdoc cref="poll_image(string, ref uint, ref uint, TextBuffer, ref uint, ref uint, ref uint, TextBuffer, ref uint, ref byte, ref uint, byte[], ref uint)"/>
        public static bool poll_image(
            string topic, ref uint sec, ref uint nanosec, TextBuffer frame_id, ref int frame_id_size,
            ref uint height, ref uint width, TextBuffer encoding, ref int encoding_size,
            ref byte is_bigendian, ref uint step, byte[] data, ref int data_size)
        {
            uint bytes = Unsigned(frame_id_size);
            uint encodingBytes = Unsigned(encoding_size);
            uint dataBytes = Unsigned(data_size);
            bool isThere = poll_image(
                topic, ref sec, ref nanosec, frame_id, ref bytes, ref height, ref width, encoding, ref encodingBytes,
                ref is_bigendian, ref step, data, ref dataBytes);
            frame_id_size = (int)bytes;
            encoding_size = (int)encodingBytes;
            data_size = (int)dataBytes;
            return isThere;
        }

        /// <summary>Takes the oldest unread picture, as pixels.</summary>
        public static bool poll_image(string topic, out ImageMsg image)
        {
            return Poll("poll_image", topic, out image);
        }

        /// <summary>Takes the oldest unread picture, as JPEG or PNG.</summary>
        /// <param name="frame_id_size">How many bytes fit. Becomes how many were written, as all sizes.</param>
        /// <returns>False without a message, or if it does not fit: then it stays, and a debug message says why.</returns>
        public static bool poll_compressed_image(
            string topic, ref uint sec, ref uint nanosec, TextBuffer frame_id, ref uint frame_id_size,
            TextBuffer format, ref uint format_size, byte[] data, ref uint data_size)
        {
            lock (Gate)
            {
                const string Call = "poll_compressed_image";
                CompressedImageMsg image;
                if (!Oldest(Call, topic, out image)
                    || !Fits(Call, topic, "frame_id", frame_id, frame_id_size, image.header.frame_id)
                    || !Fits(Call, topic, "format", format, format_size, image.format)
                    || !Fits(Call, topic, "data", data, data_size, image.data.Length))
                {
                    frame_id_size = 0;
                    format_size = 0;
                    data_size = 0;
                    return false;
                }
                Put(image.header, ref sec, ref nanosec, frame_id, ref frame_id_size);
                format_size = format.Write(image.format);
                data_size = Copied(image.data, data);
                return Taken(topic, image);
            }
        }

        /// <inheritdoc cref="poll_compressed_image(string, ref uint, ref uint, TextBuffer, ref uint, TextBuffer, ref uint, byte[], ref uint)"/>
        public static bool poll_compressed_image(
            string topic, ref uint sec, ref uint nanosec, TextBuffer frame_id, ref int frame_id_size,
            TextBuffer format, ref int format_size, byte[] data, ref int data_size)
        {
            uint bytes = Unsigned(frame_id_size);
            uint formatBytes = Unsigned(format_size);
            uint dataBytes = Unsigned(data_size);
            bool isThere = poll_compressed_image(
                topic, ref sec, ref nanosec, frame_id, ref bytes, format, ref formatBytes, data, ref dataBytes);
            frame_id_size = (int)bytes;
            format_size = (int)formatBytes;
            data_size = (int)dataBytes;
            return isThere;
        }

        /// <summary>Takes the oldest unread picture, as JPEG or PNG.</summary>
        public static bool poll_compressed_image(string topic, out CompressedImageMsg image)
        {
            return Poll("poll_compressed_image", topic, out image);
        }
    }
}
