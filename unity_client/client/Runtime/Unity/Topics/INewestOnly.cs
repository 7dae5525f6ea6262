// SPDX-License-Identifier: Apache-2.0
using System;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>A component that may show or send only the newest message, so that no other has to wait.</summary>
    internal interface INewestOnly
    {
        /// <summary>Whether it does so. Else it needs every message.</summary>
        bool IsNewestOnly { get; }
    }

    /// <summary>A display that needs messages in another form than the gateway's own.</summary>
    internal interface IAsks
    {
        /// <summary>Changes the options of a subscription to whole messages of a type.</summary>
        void Ask(string type, SubscribeOptions options);
    }

    /// <summary>How many messages should wait where nobody chose a number.</summary>
    internal static class QueueDefault
    {
        /// <summary>1 if the newest is enough for all that stands next to a component. Else *many*.</summary>
        internal static int Beside(Component component, int many)
        {
            INewestOnly[] beside = component.GetComponents<INewestOnly>();
            return beside.Length > 0 && Array.TrueForAll(beside, one => one.IsNewestOnly) ? 1 : many;
        }
    }
}
