// SPDX-License-Identifier: Apache-2.0
using System;
using static Ros2Gateway.Thesis.Ros2Library;

namespace Ros2Gateway.Tests
{
    /// <summary>
    /// Every poll with a buffer, as a program has it that declared texts as bytes, and a size_t* as ref int, ref ulong
    /// or ref UIntPtr.
    /// </summary>
    internal sealed class AnotherProgramOf2021
    {
        public string Text, Encoding, Format, ChildFrameId;
        public UIntPtr ImageSize, PictureSize, CellAmount;
        public ulong RangesSize;
        public float Voltage;
        public double QuatW;
        public bool HasString, HasHeader, HasBattery, HasOdometry, HasImage, HasPicture, HasScan;

        private readonly byte[] _frame = new byte[64];
        private readonly byte[] _text = new byte[64];
        private readonly byte[] _more = new byte[64];
        private readonly byte[] _data = new byte[1000000];
        private readonly float[] _ranges = new float[2000];
        private readonly float[] _intensities = new float[2000];
        private uint _sec, _nanosec, _height, _width, _step;
        private byte _byte, _health, _technology;
        private float _float;
        private double _double;
        private bool _bool;

        public bool HasEverything => HasString && HasHeader && HasBattery && HasOdometry && HasImage && HasPicture && HasScan;

        public bool Start()
        {
            int backlog = 10;
            ros2_init("unity");
            return add_publisher("/old/string", 0, backlog) && add_subscriber("/old/string", 0, backlog, backlog)
                && add_publisher("/old/header", 2, backlog) && add_subscriber("/old/header", 2, backlog, backlog)
                && add_subscriber("/camera/image_raw", 5, 1, 1)
                && add_subscriber("/battery_state", 6, backlog, backlog)
                && add_subscriber("/scan", 7, 1, 1)
                && add_subscriber("/camera/image_raw/compressed", 8, 1, 1)
                && add_subscriber("/odom", 9, 1, 1);
        }

        public bool Send() => send_string("/old/string", "hello robot") && send_header("/old/header", 1, 2, "map");

        public void Update()
        {
            int frame = _frame.Length;
            ulong text = (ulong)_text.Length;
            if (poll_string("/old/string", _text, ref text))
            {
                HasString = true;
                Text = Read(_text, text);
            }
            HasHeader |= poll_header("/old/header", ref _sec, ref _nanosec, _frame, ref frame);
            frame = _frame.Length;
            text = (ulong)_text.Length;
            UIntPtr more = new(64);
            CellAmount = UIntPtr.Zero;
            HasBattery |= poll_battery_state(
                "/battery_state", ref _sec, ref _nanosec, _frame, ref frame, ref Voltage, ref _float, ref _float,
                ref _float, ref _float, ref _float, ref _float, ref _byte, ref _health, ref _technology, ref _bool,
                null, null, ref CellAmount, _text, ref text, _more, ref more);
            frame = _frame.Length;
            text = (ulong)_text.Length;
            if (poll_odometry(
                "/odom", ref _sec, ref _nanosec, _frame, ref frame, _text, ref text, true,
                ref _double, ref _double, ref _double, ref _double, ref _double, ref _double, ref QuatW, null,
                ref _double, ref _double, ref _double, ref _double, ref _double, ref _double, null))
            {
                HasOdometry = true;
                ChildFrameId = Read(_text, text);
            }
            frame = _frame.Length;
            text = (ulong)_text.Length;
            UIntPtr data = new(1000000);
            if (poll_image(
                "/camera/image_raw", ref _sec, ref _nanosec, _frame, ref frame, ref _height, ref _width,
                _text, ref text, ref _byte, ref _step, _data, ref data))
            {
                HasImage = true;
                Encoding = Read(_text, text);
                ImageSize = data;
            }
            frame = _frame.Length;
            text = (ulong)_text.Length;
            data = new UIntPtr(1000000);
            if (poll_compressed_image(
                "/camera/image_raw/compressed", ref _sec, ref _nanosec, _frame, ref frame, _text, ref text,
                _data, ref data))
            {
                HasPicture = true;
                Format = Read(_text, text);
                PictureSize = data;
            }
            frame = _frame.Length;
            ulong ranges = (ulong)_ranges.Length;
            int intensities = _intensities.Length;
            if (poll_laser_scan(
                "/scan", ref _sec, ref _nanosec, _frame, ref frame, ref _float, ref _float, ref _float, ref _float,
                ref _float, ref _float, ref _float, _ranges, ref ranges, _intensities, ref intensities))
            {
                HasScan = true;
                RangesSize = ranges;
            }
        }

        private static string Read(byte[] bytes, ulong size) => System.Text.Encoding.UTF8.GetString(bytes, 0, (int)size);
    }
}
