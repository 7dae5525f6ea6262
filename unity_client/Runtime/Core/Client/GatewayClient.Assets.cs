// SPDX-License-Identifier: Apache-2.0
using System;
using System.Threading;
using System.Threading.Tasks;

namespace Ros2Gateway
{
    /// <content>
    /// Files of the robot's packages that the gateway serves, such as meshes. They come in chunks, one asked for after
    /// the other, so that other frames pass between them. 64 MiB at most.
    /// </content>
    public sealed partial class GatewayClient
    {
        /// <summary>Fetches a file. *Done* is called by <see cref="Pump"/>, once, whatever happens.</summary>
        /// <param name="uri">Such as package://arm/meshes/upper.stl.</param>
        /// <param name="timeoutMilliseconds">For each chunk. 0 for <see cref="GatewayOptions.CallMilliseconds"/>.</param>
        public void FetchAsset(string uri, Action<Reply<byte[]>> done, int timeoutMilliseconds = 0)
        {
            StartFetch(uri, done, timeoutMilliseconds);
        }

        /// <summary>Fetches a file, to await.</summary>
        /// <param name="uri">Such as package://arm/meshes/upper.stl.</param>
        /// <param name="cancellation">Ends the waiting, and asks for no more chunks.</param>
        /// <param name="timeoutMilliseconds">For each chunk. 0 for <see cref="GatewayOptions.CallMilliseconds"/>.</param>
        public Task<byte[]> FetchAssetAsync(
            string uri, CancellationToken cancellation = default(CancellationToken), int timeoutMilliseconds = 0)
        {
            if (cancellation.IsCancellationRequested)
            {
                return Task.FromCanceled<byte[]>(cancellation);
            }
            AwaitedReply<byte[]> awaited = new AwaitedReply<byte[]>(_awaited, AssetFetch.What(uri), cancellation);
            AssetFetch fetch = StartFetch(uri, awaited.Answer, timeoutMilliseconds, true);
            awaited.OnCancelled(() =>
            {
                if (fetch.Cancel())
                {
                    _mailbox.Post("a cancellation", awaited.Cancel);
                }
            });
            return awaited.Task;
        }

        /// <summary>Like <see cref="FetchAsset"/>, of what can be given up.</summary>
        internal AssetFetch StartFetch(
            string uri, Action<Reply<byte[]>> done, int timeoutMilliseconds = 0, bool isAwaited = false)
        {
            AssetFetch fetch = new AssetFetch(
                _requests, _reports, uri, timeoutMilliseconds > 0 ? timeoutMilliseconds : _options.CallMilliseconds, done,
                isAwaited);
            fetch.Start();
            return fetch;
        }
    }
}
