// SPDX-License-Identifier: Apache-2.0
namespace Ros2Gateway.Pictures
{
    /// <summary>How large pictures should come, by how large they are shown.</summary>
    public static class PictureBound
    {
        private const double Spare = 1.25; // or it would change with each step of someone who walks before the screen

        // usual widths of pictures, each a third or a half longer
        private static readonly int[] Steps = { 160, 240, 320, 480, 640, 960, 1280, 1920, 2560, 3840 };

        /// <summary>
        /// The longest side to ask for, in pixels. 0 for no bound. It grows as soon as the picture takes more pixels
        /// of the screen, and shrinks where a quarter more pixels would still fit.
        /// </summary>
        /// <param name="asked">The one that is asked for now. 0 for no bound.</param>
        /// <param name="pixels">How many pixels of the screen the longer side takes. Infinite if nobody knows.</param>
        public static int Next(int asked, double pixels)
        {
            if (asked > 0 && pixels > asked)
            {
                return Above(pixels);
            }
            int smaller = Above(pixels * Spare);
            return smaller > 0 && (asked == 0 || smaller < asked) ? smaller : asked;
        }

        private static int Above(double pixels)
        {
            foreach (int step in Steps)
            {
                if (pixels <= step)
                {
                    return step;
                }
            }
            return 0;
        }
    }
}
