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
        protected override string AddressField
        {
            get { return nameof(GatewaySettings.Address); }
        }

        /// <inheritdoc/>
        protected override GatewayOptions Options()
        {
            return ((GatewaySettings)target).Options();
        }
    }
}
