// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Messages.SensorMsgs;

namespace Ros2Gateway.Thesis
{
    /// <content>Pictures.</content>
    public static partial class Ros2Library
    {
        /// <summary>Takes the oldest unread picture, as pixels.</summary>
        /// <param name="frame_id_size">How many bytes fit. Becomes how many were written, as all sizes.</param>
        /// <returns>False without a message, or if an array is too small: then it stays, and a debug message says why.</returns>
        public static bool poll_image<TFrame, TEncoding, TData>(
            string topic, ref uint sec, ref uint nanosec, TextBuffer frame_id, ref TFrame frame_id_size,
            ref uint height, ref uint width, TextBuffer encoding, ref TEncoding encoding_size,
            ref byte is_bigendian, ref uint step, byte[] data, ref TData data_size)
            where TFrame : struct
            where TEncoding : struct
            where TData : struct
        {
            lock (Gate)
            {
                const string Call = "poll_image";
                if (!Oldest(Call, topic, out ImageMsg image)
                    || !Fits(Call, topic, "data", data, data_size, image.data.Length))
                {
                    frame_id_size = default(TFrame);
                    encoding_size = default(TEncoding);
                    data_size = default(TData);
                    return false;
                }
                Put(Call, topic, image.header, ref sec, ref nanosec, frame_id, ref frame_id_size);
                height = image.height;
                width = image.width;
                Put(Call, topic, "encoding", image.encoding, encoding, ref encoding_size);
                is_bigendian = image.is_bigendian;
                step = image.step;
                Copy(image.data, data, out data_size);
                return Taken(topic, image);
            }
        }

        /// <summary>Takes the oldest unread picture, as JPEG or PNG.</summary>
        /// <param name="frame_id_size">How many bytes fit. Becomes how many were written, as all sizes.</param>
        /// <returns>False without a message, or if an array is too small: then it stays, and a debug message says why.</returns>
        public static bool poll_compressed_image<TFrame, TFormat, TData>(
            string topic, ref uint sec, ref uint nanosec, TextBuffer frame_id, ref TFrame frame_id_size,
            TextBuffer format, ref TFormat format_size, byte[] data, ref TData data_size)
            where TFrame : struct
            where TFormat : struct
            where TData : struct
        {
            lock (Gate)
            {
                const string Call = "poll_compressed_image";
                if (!Oldest(Call, topic, out CompressedImageMsg image)
                    || !Fits(Call, topic, "data", data, data_size, image.data.Length))
                {
                    frame_id_size = default(TFrame);
                    format_size = default(TFormat);
                    data_size = default(TData);
                    return false;
                }
                Put(Call, topic, image.header, ref sec, ref nanosec, frame_id, ref frame_id_size);
                Put(Call, topic, "format", image.format, format, ref format_size);
                Copy(image.data, data, out data_size);
                return Taken(topic, image);
            }
        }
    }
}
