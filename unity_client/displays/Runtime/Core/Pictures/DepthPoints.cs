// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Messages.SensorMsgs;

namespace Ros2Gateway.Pictures
{
    /// <summary>
    /// A depth picture as points in the camera's optical frame: x to the right, y down, z ahead (REP 103).
    /// </summary>
    /// <remarks>The picture is a PNG of 16-bit millimetres, as the gateway makes it of 16UC1 and 32FC1.</remarks>
    public sealed class DepthPoints
    {
        private const double Metres = 0.001; // of a millimetre

        private readonly GreyPng _png = new(2);
        private double _focalX; // as a share of the width, so that it holds for any size of the picture
        private double _focalY; // as a share of the height. 0 for pixels that are square
        private double _centerX = 0.5;
        private double _centerY = 0.5;

        /// <summary>Points of a camera with square pixels.</summary>
        /// <param name="horizontalView">How much it sees from left to right, in radians.</param>
        public DepthPoints(double horizontalView) => View(horizontalView);

        /// <summary>Pixels a row.</summary>
        public int Width => _png.Width;

        /// <summary>Rows.</summary>
        public int Height => _png.Height;

        /// <summary>Sets how much the camera sees from left to right, in radians. An invalid view becomes a quarter turn.</summary>
        public void View(double horizontal)
        {
            double half = horizontal > 0 && horizontal < Math.PI ? horizontal / 2 : Math.PI / 4;
            _focalX = 0.5 / Math.Tan(half);
            _focalY = 0;
            _centerX = _centerY = 0.5;
        }

        /// <summary>Takes what the camera says of itself. Returns what is wrong with it, or null.</summary>
        public string View(CameraInfoMsg info)
        {
            double[] k = info.k;
            if (info.width == 0 || info.height == 0 || k == null || k.Length != 9 || !(k[0] > 0) || !(k[4] > 0))
            {
                return "the camera is not calibrated: its focal length is 0";
            }
            _focalX = k[0] / info.width;
            _focalY = k[4] / info.height;
            _centerX = k[2] / info.width;
            _centerY = k[5] / info.height;
            return null;
        }

        /// <summary>Reads a picture. Returns what is wrong with it, or null.</summary>
        public string Read(byte[] png) => _png.Read(png);

        /// <summary>The point of a pixel. False where nothing was measured.</summary>
        public bool TryGet(int x, int y, out Vector3<Flu> point)
        {
            int at = 2 * (y * _png.Width + x);
            double depth = Metres * (_png.Pixels[at] << 8 | _png.Pixels[at + 1]);
            double focalX = _focalX * _png.Width;
            double focalY = _focalY > 0 ? _focalY * _png.Height : focalX;
            point = new Vector3<Flu>(
                depth * (x + 0.5 - _centerX * _png.Width) / focalX,
                depth * (y + 0.5 - _centerY * _png.Height) / focalY,
                depth);
            return depth > 0;
        }
    }
}
