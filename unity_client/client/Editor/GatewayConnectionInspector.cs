// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Unity;
using UnityEditor;

namespace Ros2Gateway.Editor
{
    /// <summary>Of the connection, whose own address goes before that of its settings.</summary>
    [CustomEditor(typeof(GatewayConnection))]
    public sealed class GatewayConnectionInspector : AddressInspector
    {
        /// <inheritdoc/>
        protected override string AddressField => "_address";

        /// <inheritdoc/>
        protected override GatewayOptions Options() => ((GatewayConnection)target).Options();
    }
}
