// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Threading;
using System.Threading.Tasks;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>Parameters of ROS nodes. A node has 2.5 seconds to answer. Replies come while the client is pumped.</summary>
    public static class Parameters
    {
        private const int TimeoutMilliseconds = 3500; // the gateway gives a node 2500

        /// <summary>Asks for the names of a node's parameters.</summary>
        public static void ListParameters(this GatewayClient client, string node, Action<Reply<string[]>> done)
        {
            client.Request(
                "list_parameters",
                Members(node),
                reply => done(Map(reply, frame => Strings(frame["names"]))),
                TimeoutMilliseconds);
        }

        /// <summary>Asks for values by name. Without names for all that the node has.</summary>
        public static void GetParameters(
            this GatewayClient client, string node, string[] names, Action<Reply<JsonValue>> done)
        {
            client.Request(
                "get_parameters",
                Members(node, names),
                reply => done(Map(reply, frame => frame["values"])),
                TimeoutMilliseconds);
        }

        /// <summary>
        /// Sets values by name, each by itself. The reply holds for each {"successful", "reason"}.
        /// </summary>
        public static void SetParameters(
            this GatewayClient client, string node, JsonValue values, Action<Reply<JsonValue>> done)
        {
            client.Request(
                "set_parameters",
                Members(node).With("values", values),
                reply => done(Map(reply, frame => frame["results"])),
                TimeoutMilliseconds);
        }

        /// <summary>Asks for types, ranges and words. Without names of all that the node has.</summary>
        public static void DescribeParameters(
            this GatewayClient client, string node, string[] names, Action<Reply<JsonValue>> done)
        {
            client.Request(
                "describe_parameters",
                Members(node, names),
                reply => done(Map(reply, frame => frame["parameters"])),
                TimeoutMilliseconds);
        }

        /// <summary>Asks for the names of a node's parameters, to await. A token ends the waiting.</summary>
        public static async Task<string[]> ListParametersAsync(
            this GatewayClient client, string node, CancellationToken cancellation = default(CancellationToken))
        {
            JsonValue frame = await client.RequestAsync("list_parameters", Members(node), cancellation, TimeoutMilliseconds);
            return Strings(frame["names"]);
        }

        /// <summary>Asks for values by name, to await. Without names for all that the node has.</summary>
        public static async Task<JsonValue> GetParametersAsync(
            this GatewayClient client, string node, string[] names = null,
            CancellationToken cancellation = default(CancellationToken))
        {
            JsonValue frame = await client.RequestAsync("get_parameters", Members(node, names), cancellation, TimeoutMilliseconds);
            return frame["values"];
        }

        /// <summary>
        /// Sets values by name, each by itself, to await. The result holds for each {"successful", "reason"}.
        /// </summary>
        public static async Task<JsonValue> SetParametersAsync(
            this GatewayClient client, string node, JsonValue values,
            CancellationToken cancellation = default(CancellationToken))
        {
            JsonValue frame = await client.RequestAsync(
                "set_parameters", Members(node).With("values", values), cancellation, TimeoutMilliseconds);
            return frame["results"];
        }

        /// <summary>Asks for types, ranges and words, to await. Without names of all that the node has.</summary>
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

        private static string[] Strings(JsonValue list)
        {
            List<string> strings = new List<string>();
            foreach (JsonValue item in list.Items)
            {
                strings.Add(item.AsString(""));
            }
            return strings.ToArray();
        }

        private static Reply<T> Map<T>(Reply<JsonValue> reply, Func<JsonValue, T> value)
        {
            return reply.Ok ? Reply<T>.Of(value(reply.Value)) : Reply<T>.Failed(reply.Error);
        }
    }
}
