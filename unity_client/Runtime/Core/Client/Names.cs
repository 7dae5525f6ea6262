// SPDX-License-Identifier: Apache-2.0
namespace Ros2Gateway
{
    /// <summary>Names of topics, services and actions.</summary>
    internal static class Names
    {
        /// <summary>With a leading slash: what the gateway sends carries names exactly as they were written.</summary>
        internal static string Absolute(string name)
        {
            return string.IsNullOrEmpty(name) || name[0] == '/' ? name ?? "" : "/" + name;
        }
    }
}
