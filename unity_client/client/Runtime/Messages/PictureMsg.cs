// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Json;
using Ros2Gateway.Messages.BuiltinInterfaces;
using Ros2Gateway.Messages.SensorMsgs;
using Ros2Gateway.Messages.StdMsgs;

namespace Ros2Gateway.Pictures
{
    /// <summary>
    /// A <see cref="CompressedImageMsg"/> whose bytes are the first of a buffer: one that is filled again
    /// (<c>Subscribe(..., reuse: true)</c>) allocates nothing, although no two pictures have one length.
    /// </summary>
    public sealed class PictureMsg : IMessage
    {
        /// <summary>Time, and frame of the camera.</summary>
        public HeaderMsg header = new();

        /// <summary>As in CompressedImage: "jpeg", "rgb8. Jpeg compressed bgr8".</summary>
        public string format = "";

        /// <summary>The picture, and behind it what is left of longer ones.</summary>
        public byte[] buffer = Array.Empty<byte>();

        /// <summary>How many bytes of the buffer are the picture.</summary>
        public int count;

        private static readonly JsonMembers Members = new("header", "format", "data");

        /// <inheritdoc/>
        public string RosType => CompressedImageMsg.Type;

        /// <inheritdoc/>
        public void Read(JsonReader reader)
        {
            reader.BeginObject();
            int member = JsonMembers.Unknown;
            while (reader.NextMember(Members, ref member))
            {
                switch (member)
                {
                    case 0:
                        header.Read(reader);
                        break;
                    case 1:
                        format = reader.ReadString();
                        break;
                    case 2:
                        count = reader.ReadBytes(ref buffer);
                        break;
                    default:
                        reader.Skip();
                        break;
                }
            }
        }

        /// <inheritdoc/>
        public void Write(JsonWriter writer) => Copy().Write(writer);

        /// <summary>The same as its own message, to be kept.</summary>
        public CompressedImageMsg Copy()
        {
            var copy = new CompressedImageMsg { format = format, data = new byte[count] };
            copy.header.stamp = new TimeMsg { sec = header.stamp.sec, nanosec = header.stamp.nanosec };
            copy.header.frame_id = header.frame_id;
            Buffer.BlockCopy(buffer, 0, copy.data, 0, count);
            return copy;
        }
    }
}
