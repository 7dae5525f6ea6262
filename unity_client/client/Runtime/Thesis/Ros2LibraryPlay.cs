// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Thesis;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// Ends <see cref="Ros2Library"/> with the Play that began it: where the editor keeps static state from one Play
    /// to the next, its connection would live on in Edit mode, and drive.
    /// </summary>
    internal static class Ros2LibraryPlay
    {
        [RuntimeInitializeOnLoadMethod(RuntimeInitializeLoadType.SubsystemRegistration)]
        private static void Begin()
        {
            Ros2Library.ros2_shutdown();
            Application.quitting -= Ros2Library.ros2_shutdown;
            Application.quitting += Ros2Library.ros2_shutdown;
        }
    }
}
