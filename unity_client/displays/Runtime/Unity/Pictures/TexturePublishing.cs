// SPDX-License-Identifier: Apache-2.0
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>Textures for scripts that have a Topic Publisher.</summary>
    public static class TexturePublishing
    {
        /// <summary>
        /// Publishes a texture as JPEG, if its rate allows it now. Its type must be
        /// sensor_msgs/msg/CompressedImage. If the GPU can be read without waiting for it, the image follows
        /// some frames later, with the time of this call, and is encoded on another thread. A call until then
        /// returns false. Elsewhere (WebGL, OpenGL ES of old phones), and once five pictures in a row could not be read
        /// so, this waits for the GPU, and encodes.
        /// </summary>
        /// <remarks>Adds a <see cref="TexturePublisher"/> next to it, which holds the buffers.</remarks>
        /// <returns>Whether the picture was published, or is under way.</returns>
        public static bool PublishTexture(this TopicPublisher publisher, Texture texture, string frameId = "")
        {
            TexturePublisher holder = publisher.GetComponent<TexturePublisher>();
            holder ??= publisher.gameObject.AddComponent<TexturePublisher>();
            return holder.Stream.Publish(texture, frameId);
        }
    }
}
