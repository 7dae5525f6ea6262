// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Messages.SensorMsgs;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>The places of a point and its colour in the bytes of a sensor_msgs/msg/PointCloud2.</summary>
    internal struct PointCloudLayout
    {
        private const int FieldBytes = 4; // float32, or a colour in as many

        private byte[] _bytes;
        private bool _isBigEndian;
        private int _x;
        private int _y;
        private int _z;
        private int _color; // -1 for none
        private bool _hasAlpha;
        private long _width;
        private long _rowStep;
        private long _pointStep;

        /// <summary>The number of points. Points beyond the data are not counted.</summary>
        internal long Count { get; private set; }

        /// <summary>Whether the data end before the points that the message speaks of.</summary>
        internal bool IsTruncated { get; private set; }

        /// <summary>Understands the message. Null, or what is wrong with it.</summary>
        internal string Read(PointCloud2Msg message)
        {
            _bytes = message.data ?? Array.Empty<byte>();
            _isBigEndian = message.is_bigendian;
            _pointStep = message.point_step;
            _width = message.width;
            _rowStep = message.height > 1 ? message.row_step : 0; // with one row drivers leave it out
            _x = _y = _z = _color = -1;
            _hasAlpha = false;
            foreach (PointFieldMsg field in message.fields ?? Array.Empty<PointFieldMsg>())
            {
                string refusal = Take(field);
                if (refusal != null)
                {
                    return refusal;
                }
            }
            if (_x < 0 || _y < 0 || _z < 0)
            {
                return "a point cloud needs the fields x, y and z";
            }
            if (message.height > 1 && _rowStep < _width * _pointStep)
            {
                return "a row of " + _width + " points needs " + _width * _pointStep
                    + " bytes, row_step is " + _rowStep;
            }
            ulong points = (ulong)message.width * message.height;
            long room = _bytes.Length / _pointStep;
            IsTruncated = points > (ulong)room
                || (points > 0 && (message.height - 1) * _rowStep + _width * _pointStep > _bytes.Length);
            Count = points > (ulong)room ? room : (long)points;
            return null;
        }

        /// <summary>Reads a point. False if it is NaN, or beyond the data.</summary>
        internal bool TryGet(long index, out Vector3<Flu> point, out Color32 color)
        {
            point = default(Vector3<Flu>);
            color = default(Color32);
            long start = index / _width * _rowStep + index % _width * _pointStep;
            if (start + _pointStep > _bytes.Length)
            {
                return false;
            }
            int at = (int)start;
            float x = Single(at + _x), y = Single(at + _y), z = Single(at + _z);
            float sum = x + y + z;
            if (float.IsNaN(sum) || float.IsInfinity(sum))
            {
                return false;
            }
            point = new Vector3<Flu>(x, y, z);
            if (_color >= 0)
            {
                uint packed = Word(at + _color); // 0xAARRGGBB, whatever its type is
                byte alpha = _hasAlpha ? (byte)(packed >> 24) : byte.MaxValue;
                color = new Color32((byte)(packed >> 16), (byte)(packed >> 8), (byte)packed, alpha);
            }
            return true;
        }

        /// <summary>Whether points have colours.</summary>
        internal bool HasColor => _color >= 0;

        private string Take(PointFieldMsg field)
        {
            bool isCoordinate = field.name == "x" || field.name == "y" || field.name == "z";
            bool isColor = field.name == "rgb" || field.name == "rgba";
            if (!isCoordinate && !isColor)
            {
                return null;
            }
            if (field.offset + (long)FieldBytes > _pointStep)
            {
                return "field " + field.name + " needs " + FieldBytes + " bytes at offset " + field.offset
                    + ", point_step is " + _pointStep;
            }
            bool isSingle = field.datatype == PointFieldMsg.FLOAT32;
            if (!isSingle && !(isColor && field.datatype == PointFieldMsg.UINT32))
            {
                return "field " + field.name + " has datatype " + field.datatype + ", expected "
                    + PointFieldMsg.FLOAT32 + " (float32)";
            }
            int offset = (int)field.offset;
            _x = field.name == "x" ? offset : _x;
            _y = field.name == "y" ? offset : _y;
            _z = field.name == "z" ? offset : _z;
            _color = isColor ? offset : _color;
            _hasAlpha |= field.name == "rgba";
            return null;
        }

        private float Single(int at) => BitConverter.Int32BitsToSingle((int)Word(at));

        private uint Word(int at)
        {
            byte[] bytes = _bytes;
            return _isBigEndian
                ? (uint)(bytes[at] << 24 | bytes[at + 1] << 16 | bytes[at + 2] << 8 | bytes[at + 3])
                : (uint)(bytes[at + 3] << 24 | bytes[at + 2] << 16 | bytes[at + 1] << 8 | bytes[at]);
        }
    }
}
