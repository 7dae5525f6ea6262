// SPDX-License-Identifier: Apache-2.0
namespace Ros2Gateway.Unity
{
    /// <summary>The words that a driver last had for how things stand.</summary>
    internal sealed class DriveStatus
    {
        /// <summary>Of a driver that waits for one.</summary>
        internal const string NoConnection = "no Gateway Connection";

        internal string Text { get; private set; } = "";

        /// <summary>Takes the words of now. Returns whether they are others.</summary>
        internal bool Take(string text)
        {
            if (text == Text)
            {
                return false;
            }
            Text = text;
            return true;
        }
    }
}
