// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>The options of a subscription beyond topic and type.</summary>
    public sealed class SubscribeOptions
    {
        /// <summary>As in ROS: 10.</summary>
        public const int DefaultQueue = 10;

        /// <summary>
        /// How many messages may wait for the application from frame to frame, before the oldest is dropped. Messages
        /// of the last two frames wait in addition, up to 1024 messages and 1 MiB. 1 is always the newest alone:
        /// for pictures, scans, and poses that only place something.
        /// </summary>
        public int Queue = DefaultQueue;

        /// <summary>Whether bursts wait next to the queue. False where a library of old is taken at its word.</summary>
        internal bool KeepsBursts = true;

        /// <summary>At most one message in so many milliseconds, the newest. 0 for all.</summary>
        public double ThrottleMilliseconds;

        /// <summary>Only these fields, as dotted paths ("pose.pose.position"). Null for all.</summary>
        public string[] Fields;

        /// <summary>
        /// Whether messages come in binary frames (CBOR), without base64 and text. Null: those of types whose
        /// bulk is an array, pictures, scans, clouds and maps.
        /// </summary>
        public bool? Binary;

        /// <summary>
        /// The form of images of sensor_msgs/msg/Image. Null for the gateway's defaults. The format png makes
        /// nav_msgs/msg/OccupancyGrid smaller on its way as well, and needs <see cref="PackedInt8s"/>.
        /// </summary>
        public ImageOptions Image;

        /// <summary>
        /// Unpacks the cells of a grid that comes as a PNG. Any thread. The gateway sends one form to a client, so this
        /// serves all subscriptions of the client to the topic. The displays have it: <c>OccupancyGridPng.Cells</c>.
        /// </summary>
        public System.Func<byte[], sbyte[]> PackedInt8s;

        /// <summary>Quality of service. Null to take what the publishers offer, which is nearly always right.</summary>
        public QosOptions Qos;
    }

    /// <summary>How the gateway should send sensor_msgs/msg/Image: as JPEG, of this size and rate.</summary>
    public sealed class ImageOptions
    {
        /// <summary>"jpeg", "png" or "raw". Null for the gateway's default, mostly JPEG.</summary>
        public string Format;

        /// <summary>1 to 100, of JPEG. 0 for the gateway's default.</summary>
        public int Quality;

        /// <summary>Whether pictures may be smaller than asked for on a slow link. Null: unless a quality is set.</summary>
        public bool? Adapt;

        /// <summary>Scaled down to fit, in pixels. 0 for no bound.</summary>
        public int MaxWidth;

        /// <summary>Scaled down to fit, in pixels. 0 for no bound.</summary>
        public int MaxHeight;

        /// <summary>At most so many pictures a second. 0 for all.</summary>
        public double MaxFps;

        internal void Write(JsonWriter writer, int maxWidth, int maxHeight)
        {
            writer.Name("image");
            writer.BeginObject();
            if (!string.IsNullOrEmpty(Format))
            {
                writer.Name("format").Value(Format);
            }
            if (Quality > 0)
            {
                writer.Name("quality").Value(Quality);
            }
            if (Adapt.HasValue)
            {
                writer.Name("adapt").Value(Adapt.Value);
            }
            if (maxWidth > 0)
            {
                writer.Name("max_width").Value(maxWidth);
            }
            if (maxHeight > 0)
            {
                writer.Name("max_height").Value(maxHeight);
            }
            if (MaxFps > 0)
            {
                writer.Name("max_fps").Value(MaxFps);
            }
            writer.EndObject();
        }
    }

    /// <summary>Quality of service in ROS' words. Null or 0 leaves a value to the gateway.</summary>
    public sealed class QosOptions
    {
        /// <summary>"reliable", "best_effort" or "best_available".</summary>
        public string Reliability;

        /// <summary>"volatile", "transient_local" or "best_available".</summary>
        public string Durability;

        /// <summary>How many messages DDS keeps.</summary>
        public int Depth;

        internal void Write(JsonWriter writer)
        {
            writer.Name("qos");
            writer.BeginObject();
            if (!string.IsNullOrEmpty(Reliability))
            {
                writer.Name("reliability").Value(Reliability);
            }
            if (!string.IsNullOrEmpty(Durability))
            {
                writer.Name("durability").Value(Durability);
            }
            if (Depth > 0)
            {
                writer.Name("depth").Value(Depth);
            }
            writer.EndObject();
        }
    }
}
