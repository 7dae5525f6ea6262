// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>What a subscription asks for beyond topic and type.</summary>
    public sealed class SubscribeOptions
    {
        /// <summary>
        /// How many messages may wait for the application, the oldest being dropped. 1, the default, is
        /// always the newest; more keeps every message in order, as long as they are taken fast enough.
        /// </summary>
        public int Queue = 1;

        /// <summary>At most one message in so many milliseconds, the newest; 0 for all.</summary>
        public double ThrottleMilliseconds;

        /// <summary>Only these fields, as dotted paths ("pose.pose.position"); null for all.</summary>
        public string[] Fields;

        /// <summary>What pictures of sensor_msgs/msg/Image should be like; null for the gateway's defaults.</summary>
        public ImageOptions Image;

        /// <summary>Quality of service; null to take what the publishers offer, which is nearly always right.</summary>
        public QosOptions Qos;
    }

    /// <summary>How the gateway should send sensor_msgs/msg/Image: as JPEG, of this size and rate.</summary>
    public sealed class ImageOptions
    {
        /// <summary>"jpeg", "png" or "raw"; null for the gateway's default, mostly JPEG.</summary>
        public string Format;

        /// <summary>1 to 100, of JPEG; 0 for the gateway's default.</summary>
        public int Quality;

        /// <summary>Whether pictures may be smaller than asked for on a slow link; null: unless a quality is set.</summary>
        public bool? Adapt;

        /// <summary>Scaled down to fit, in pixels; 0 for no bound.</summary>
        public int MaxWidth;

        /// <summary>Scaled down to fit, in pixels; 0 for no bound.</summary>
        public int MaxHeight;

        /// <summary>At most so many pictures a second; 0 for all.</summary>
        public double MaxFps;

        internal void Write(JsonWriter writer)
        {
            writer.BeginObject();
            if (!string.IsNullOrEmpty(Format))
            {
                writer.Member("format", Format);
            }
            if (Quality > 0)
            {
                writer.Member("quality", Quality);
            }
            if (Adapt.HasValue)
            {
                writer.Member("adapt", Adapt.Value);
            }
            if (MaxWidth > 0)
            {
                writer.Member("max_width", MaxWidth);
            }
            if (MaxHeight > 0)
            {
                writer.Member("max_height", MaxHeight);
            }
            if (MaxFps > 0)
            {
                writer.Member("max_fps", MaxFps);
            }
            writer.EndObject();
        }
    }

    /// <summary>Quality of service in ROS' words; what is null or 0 is left to the gateway.</summary>
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
            writer.BeginObject();
            if (!string.IsNullOrEmpty(Reliability))
            {
                writer.Member("reliability", Reliability);
            }
            if (!string.IsNullOrEmpty(Durability))
            {
                writer.Member("durability", Durability);
            }
            if (Depth > 0)
            {
                writer.Member("depth", Depth);
            }
            writer.EndObject();
        }
    }
}
