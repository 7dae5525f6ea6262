// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Unity;
using UnityEditor;

namespace Ros2Gateway.Editor
{
    /// <summary>Of Gateway Settings.</summary>
    [CustomEditor(typeof(GatewaySettings))]
    public sealed class GatewaySettingsInspector : AddressInspector
    {
        /// <inheritdoc/>
        protected override string AddressField => nameof(GatewaySettings.Address);

        /// <inheritdoc/>
        protected override GatewayOptions Options() => ((GatewaySettings)target).Options();
    }
}
