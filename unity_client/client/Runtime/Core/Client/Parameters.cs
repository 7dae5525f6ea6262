// SPDX-License-Identifier: Apache-2.0
using System;
using System.Linq;
using System.Threading;
using System.Threading.Tasks;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>Parameters of ROS nodes. A node has 2.5 seconds to answer.</summary>
    public static class Parameters
    {
        private const int TimeoutMilliseconds = 3500; // the gateway gives a node 2500

        /// <summary>Asks for the names of a node's parameters. A token ends the waiting.</summary>
        public static async Task<string[]> ListParametersAsync(
            this GatewayClient client, string node, CancellationToken cancellation = default(CancellationToken))
        {
            JsonValue frame = await client.RequestAsync("list_parameters", Members(node), cancellation, TimeoutMilliseconds);
            return frame["names"].Items.Select(name => name.AsString("")).ToArray();
        }

        /// <summary>Asks for values by name. Without names for all that the node has.</summary>
        public static async Task<JsonValue> GetParametersAsync(
            this GatewayClient client, string node, string[] names = null,
            CancellationToken cancellation = default(CancellationToken))
        {
            JsonValue frame = await client.RequestAsync("get_parameters", Members(node, names), cancellation, TimeoutMilliseconds);
            return frame["values"];
        }

        /// <summary>
        /// Sets values by name, each by itself. The result holds for each {"successful", "reason"}.
        /// </summary>
        public static async Task<JsonValue> SetParametersAsync(
            this GatewayClient client, string node, JsonValue values,
            CancellationToken cancellation = default(CancellationToken))
        {
            JsonValue frame = await client.RequestAsync(
                "set_parameters", Members(node).With("values", values), cancellation, TimeoutMilliseconds);
            return frame["results"];
        }

        /// <summary>Asks for types, ranges and words. Without names of all that the node has.</summary>
        public static async Task<JsonValue> DescribeParametersAsync(
            this GatewayClient client, string node, string[] names = null,
            CancellationToken cancellation = default(CancellationToken))
        {
            JsonValue frame = await client.RequestAsync(
                "describe_parameters", Members(node, names), cancellation, TimeoutMilliseconds);
            return frame["parameters"];
        }

        private static JsonValue Members(string node, string[] names = null)
        {
            JsonValue members = JsonValue.Object().With("node", node);
            return names == null
                ? members
                : members.With("names", JsonValue.Array(Array.ConvertAll(names, name => (JsonValue)name)));
        }
    }
}
