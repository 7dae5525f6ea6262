// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Messages;
using Ros2Gateway.Messages.BuiltinInterfaces;
using Ros2Gateway.Messages.SensorMsgs;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>Publishes textures as JPEG by a Topic Publisher: at its rate, size and quality.</summary>
    internal sealed class TextureStream
    {
        private readonly TextureEncoder _encoder = new();
        private readonly TextureReadback _readback = new();
        private readonly TopicPublisher _by;
        private Publisher _publisher; // of the last texture
        private float _next;
        private bool _isFailureTold;

        internal TextureStream(TopicPublisher by) => _by = by;

        /// <summary>Whether <see cref="Publish"/> would take a texture now.</summary>
        internal bool IsDue => IsOpen && !_readback.IsBusy && HasType;

        private bool IsOpen => Time.unscaledTime >= _next && _by.Publisher != null && _by.Connection.Client.IsConnected;

        private bool HasType => MessageCatalogue.Resolve(_by.Type) == CompressedImageMsg.Type;

        internal bool Publish(Texture texture, string frameId)
        {
            if (!IsOpen)
            {
                return false;
            }
            if (!HasType)
            {
                return _by.Publish(new CompressedImageMsg()); // which is refused in words, before any encoding
            }
            if (!TextureEncoder.HasPixels(texture) || _readback.IsBusy)
            {
                return false;
            }
            Publisher publisher = _by.Publisher; // that of now: the component may be disabled and enabled in the meantime
            if (publisher != _publisher)
            {
                _publisher = publisher;
                _readback.Retry();
            }
            _next = Time.unscaledTime + (_by.Rate > 0 ? 1 / _by.Rate : 0);
            CompressedImageMsg picture = new() { format = "jpeg" };
            picture.header.frame_id = frameId;
            Stamp(picture.header.stamp);
            if (!TextureReadback.IsSupported || _readback.HasFailed)
            {
                picture.data = _encoder.Encode(texture, _by.ImageMaxWidth, _by.ImageMaxHeight, _by.ImageQuality);
                return _by.Publish(picture);
            }
            TextureEncoder.Fit(texture, _by.ImageMaxWidth, _by.ImageMaxHeight, out int width, out int height);
            _readback.Begin(texture, width, height, _by.ImageQuality, jpeg => Finish(publisher, picture, jpeg));
            return true;
        }

        internal void Destroy()
        {
            _encoder.Destroy();
            _readback.Destroy();
        }

        private void Finish(Publisher publisher, CompressedImageMsg picture, byte[] jpeg)
        {
            if (publisher.IsDisposed)
            {
                return;
            }
            if (jpeg == null)
            {
                publisher.Drop();
                WarnOfReadback();
                return;
            }
            picture.data = jpeg;
            publisher.Publish(picture);
        }

        private void WarnOfReadback()
        {
            if (!_isFailureTold || _readback.HasFailed)
            {
                _isFailureTold = true;
                Debug.LogWarning(
                    "Topic Publisher of " + _by.Topic + ": the GPU did not return an image, which is dropped"
                    + (_readback.HasFailed ? ", as several before: from now on the main thread waits for the GPU" : ""), _by);
            }
        }

        /// <summary>ROS time, as far as the connection knows it.</summary>
        private void Stamp(TimeMsg stamp)
        {
            double now = _by.Connection.Client.RosClock.RosSeconds;
            if (!double.IsNaN(now))
            {
                double seconds = System.Math.Floor(now);
                stamp.sec = (int)seconds;
                stamp.nanosec = (uint)((now - seconds) * 1e9);
            }
        }
    }
}
