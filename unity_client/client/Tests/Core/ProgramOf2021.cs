// SPDX-License-Identifier: Apache-2.0
using System.Text;
using static Ros2Gateway.Thesis.Ros2Library;

namespace Ros2Gateway.Tests
{
    /// <summary>
    /// A scene's code as it was written for the DLL, from the table of its calls alone: every call, texts in
    /// StringBuilders, sizes unsigned. Only the import is new.
    /// </summary>
    internal sealed class ProgramOf2021
    {
        private const uint BufferSize = 1000000;

        // What was polled
        public readonly StringBuilder Text = new(256);
        public uint TextSize;
        public double X, Y, Z, Rx, Ry, Rz;
        public uint Sec, Nanosec;
        public readonly StringBuilder FrameId = new(256);
        public uint FrameIdSize;
        public float Voltage, Temperature, Current, Charge, Capacity, DesignCapacity, Percentage;
        public byte Status, Health, Technology;
        public bool Present;
        public readonly float[] CellVoltage = new float[16];
        public readonly float[] CellTemperature = new float[16];
        public uint CellAmount;
        public readonly StringBuilder Location = new(256);
        public readonly StringBuilder SerialNumber = new(256);
        public readonly StringBuilder ChildFrameId = new(256);
        public double PoseX, PoseY, PoseZ, QuatX, QuatY, QuatZ, QuatW;
        public double VelX, VelY, VelZ, RotX, RotY, RotZ;
        public readonly double[] Covariance = new double[36];
        public readonly double[] VelCovariance = new double[36];
        public uint Height, Width, Step, ImageSize, PictureSize;
        public byte IsBigendian;
        public readonly StringBuilder Encoding = new(256);
        public readonly byte[] Image = new byte[BufferSize];
        public readonly StringBuilder Format = new(256);
        public readonly byte[] Picture = new byte[BufferSize];
        public float AngleMin, AngleMax, AngleIncrement, TimeIncrement, ScanTime, RangeMin, RangeMax;
        public readonly float[] Ranges = new float[2000];
        public readonly float[] Intensities = new float[2000];
        public uint RangesSize, IntensitiesSize;

        public bool HasString, HasTwist, HasHeader, HasBattery, HasOdometry, HasImage, HasPicture, HasScan;

        private readonly double[] _covariance = new double[36];
        private uint _sec, _nanosec, _size, _childSize, _locationSize, _serialSize, _encodingSize, _formatSize;

        public bool HasEverything =>
            HasString && HasTwist && HasHeader && HasBattery && HasOdometry && HasImage && HasPicture && HasScan;

        public bool Start()
        {
            _covariance[35] = 0.5;
            ros2_init("unity");
            uint backlog = 10;
            uint twist = 1;
            return add_publisher("/old/string", 0, backlog) && add_subscriber("/old/string", 0, backlog, backlog)
                && add_publisher("/old/twist", twist, backlog) && add_subscriber("/old/twist", twist, 10, 10)
                && add_publisher("/old/header", 2, 10) && add_subscriber("/old/header", 2, 10, 10)
                && add_publisher("/old/pose_with_cov", 3, 10)
                && add_publisher("/old/pose", 4, 10)
                && add_subscriber("/camera/image_raw", 5, 1, 1)
                && add_subscriber("/battery_state", 6, 10, 10)
                && add_subscriber("/scan", 7, 1, 1)
                && add_subscriber("/camera/image_raw/compressed", 8, 1, 1)
                && add_subscriber("/odom", 9, 1, 1);
        }

        public bool Send() =>
            send_string("/old/string", "hello robot")
                && send_twist("/old/twist", 0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
                && send_header("/old/header", 12345, 678, "map")
                && send_pose("/old/pose", 12345, 678, "map", 1, 2, 3, 0, 0, 0.6, 0.8)
                && send_pose_with_cov("/old/pose_with_cov", 12345, 678, "map", 1, 2, 3, 0, 0, 0.6, 0.8, _covariance);

        public void Update()
        {
            TextSize = 256;
            HasString |= poll_string("/old/string", Text, ref TextSize);
            HasTwist |= poll_twist("/old/twist", ref X, ref Y, ref Z, ref Rx, ref Ry, ref Rz);
            FrameIdSize = 256;
            HasHeader |= poll_header("/old/header", ref Sec, ref Nanosec, FrameId, ref FrameIdSize);
            _size = 256;
            CellAmount = 16;
            _locationSize = 256;
            _serialSize = 256;
            HasBattery |= poll_battery_state(
                "/battery_state", ref _sec, ref _nanosec, FrameId, ref _size, ref Voltage, ref Temperature, ref Current,
                ref Charge, ref Capacity, ref DesignCapacity, ref Percentage, ref Status, ref Health, ref Technology,
                ref Present, CellVoltage, CellTemperature, ref CellAmount, Location, ref _locationSize,
                SerialNumber, ref _serialSize);
            _size = 256;
            _childSize = 256;
            HasOdometry |= poll_odometry(
                "/odom", ref _sec, ref _nanosec, FrameId, ref _size, ChildFrameId, ref _childSize, false,
                ref PoseX, ref PoseY, ref PoseZ, ref QuatX, ref QuatY, ref QuatZ, ref QuatW, Covariance,
                ref VelX, ref VelY, ref VelZ, ref RotX, ref RotY, ref RotZ, VelCovariance);
            _size = 256;
            _encodingSize = 256;
            _childSize = BufferSize;
            if (poll_image(
                "/camera/image_raw", ref _sec, ref _nanosec, FrameId, ref _size, ref Height, ref Width,
                Encoding, ref _encodingSize, ref IsBigendian, ref Step, Image, ref _childSize))
            {
                HasImage = true;
                ImageSize = _childSize;
            }
            _size = 256;
            _formatSize = 256;
            _childSize = BufferSize;
            if (poll_compressed_image(
                "/camera/image_raw/compressed", ref _sec, ref _nanosec, FrameId, ref _size,
                Format, ref _formatSize, Picture, ref _childSize))
            {
                HasPicture = true;
                PictureSize = _childSize;
            }
            _size = 256;
            uint ranges = 2000;
            uint intensities = 2000;
            if (poll_laser_scan(
                "/scan", ref _sec, ref _nanosec, FrameId, ref _size, ref AngleMin, ref AngleMax, ref AngleIncrement,
                ref TimeIncrement, ref ScanTime, ref RangeMin, ref RangeMax, Ranges, ref ranges,
                Intensities, ref intensities))
            {
                HasScan = true;
                RangesSize = ranges;
                IntensitiesSize = intensities;
            }
        }

        public void OnDestroy() => ros2_shutdown();
    }
}
