// SPDX-License-Identifier: Apache-2.0
using System;
using System.Threading;
using System.Threading.Tasks;

namespace Ros2Gateway
{
    /// <summary>
    /// Files of the robot's packages that the gateway serves, such as meshes. They come in chunks, one asked for after
    /// the other, so that other frames pass between them. 64 MiB at most.
    /// </summary>
    public static class Assets
    {
        /// <summary>Fetches a file. *Done* is called by <see cref="GatewayClient.Pump"/>, once, whatever happens.</summary>
        /// <param name="uri">Such as package://arm/meshes/upper.stl.</param>
        /// <param name="timeoutMilliseconds">For each chunk. 0 for <see cref="GatewayOptions.CallMilliseconds"/>.</param>
        public static void FetchAsset(
            this GatewayClient client, string uri, Action<Reply<byte[]>> done, int timeoutMilliseconds = 0) =>
            new AssetFetch(client, uri, done, timeoutMilliseconds).Start();

        /// <summary>Fetches a file, to await.</summary>
        /// <param name="uri">Such as package://arm/meshes/upper.stl.</param>
        /// <param name="cancellation">Ends the waiting, and asks for no more chunks.</param>
        /// <param name="timeoutMilliseconds">For each chunk. 0 for <see cref="GatewayOptions.CallMilliseconds"/>.</param>
        public static Task<byte[]> FetchAssetAsync(
            this GatewayClient client, string uri, CancellationToken cancellation = default(CancellationToken),
            int timeoutMilliseconds = 0) =>
            client.Awaited<byte[]>(
                AssetFetch.What(uri), done => new AssetFetch(client, uri, done, timeoutMilliseconds).Start().Cancel,
                cancellation);
    }
}
