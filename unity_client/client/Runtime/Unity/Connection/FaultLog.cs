// SPDX-License-Identifier: Apache-2.0
using System;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// Writes exceptions of a component's listeners to Unity's console, where no connection can tell of them.
    /// </summary>
    internal static class FaultLog
    {
        /// <summary>Writes the first, the 10th, 100th ... of a listener.</summary>
        internal static void Write(Component component, string where, Exception error, long times)
        {
            GatewayEvent fault = Faults.Event(where + " of " + Name(component), error, times);
            if (fault != null)
            {
                Debug.LogError("[ROS 2 Gateway] " + fault, component); // which listener it was
                Debug.LogException(error, component);
            }
        }

        /// <summary>The component, for people. A destroyed one has lost its name.</summary>
        internal static string Name(Component component) =>
            component.GetType().Name + (component == null ? "" : " on " + component.name);
    }
}
