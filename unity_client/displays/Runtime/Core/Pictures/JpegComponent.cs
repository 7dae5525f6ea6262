// SPDX-License-Identifier: Apache-2.0
namespace Ros2Gateway.Pictures
{
    /// <summary>Brightness, or one of the two colour differences, of a JPEG: its samples and how they come.</summary>
    internal sealed class JpegComponent
    {
        /// <summary>The name that scans use.</summary>
        internal int Id;

        /// <summary>Samples in a minimum coded unit, in blocks: the sampling factors.</summary>
        internal int Horizontal;

        internal int Vertical;

        internal int QuantizationTable;

        internal HuffmanTable Dc;

        internal HuffmanTable Ac;

        /// <summary>The quantization table as it was when the scan began.</summary>
        internal readonly int[] Steps = new int[64];

        /// <summary>The DC coefficient of the block before.</summary>
        internal int Prediction;

        internal bool IsRead;

        /// <summary>Size in samples, without what fills the last blocks.</summary>
        internal int Width;

        internal int Height;

        /// <summary>Samples from a row of <see cref="Plane"/> to the next: whole units.</summary>
        internal int Stride;

        /// <summary>The samples, row by row, in whole units. Longer than that once there was a larger picture.</summary>
        internal byte[] Plane = System.Array.Empty<byte>();

        /// <summary>How many samples of the picture one of this component stands for, each way.</summary>
        internal int HorizontalScale;

        internal int VerticalScale;
    }
}
