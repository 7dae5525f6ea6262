// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway.Pictures
{
    /// <summary>The bytes are not JPEG, or a damaged one. The message says what is wrong, and where.</summary>
    public class JpegFormatException : Exception
    {
        /// <summary>An error at a byte of the JPEG, counted from 0.</summary>
        public JpegFormatException(string errorText, int offset)
            : base(errorText + " (byte " + offset + ")") =>
            Offset = offset;

        /// <summary>The place, counted from 0.</summary>
        public int Offset { get; private set; }
    }

    /// <summary>A JPEG that may be right, but of a kind that <see cref="JpegDecoder"/> does not read.</summary>
    public sealed class JpegNotSupportedException : JpegFormatException
    {
        /// <summary>The fault, and its place.</summary>
        public JpegNotSupportedException(string errorText, int offset)
            : base(errorText, offset)
        {
        }
    }
}
