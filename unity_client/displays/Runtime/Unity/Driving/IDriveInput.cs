// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Drive;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// Tells a <see cref="TeleopDriver"/> the wishes of a person. Asked once per frame.
    /// </summary>
    public interface IDriveInput
    {
        /// <summary>The driving keys that are held now.</summary>
        DriveKeys Held { get; }

        /// <summary>Whether the STOP key went down in this frame.</summary>
        bool StopPressed { get; }
    }
}
