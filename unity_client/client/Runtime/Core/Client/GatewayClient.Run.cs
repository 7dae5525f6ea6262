// SPDX-License-Identifier: Apache-2.0
using System.Threading;
using System.Threading.Tasks;

namespace Ros2Gateway
{
    /// <content>The loop for a program without frames, such as a console program or a service.</content>
    public sealed partial class GatewayClient
    {
        /// <summary>
        /// Connects, and calls handlers until the token is cancelled. Then it disconnects and returns. Handlers run one
        /// after the other, as soon as something comes. Do not call <see cref="Pump"/> next to it, and do not block in
        /// a handler.
        /// </summary>
        /// <exception cref="GatewayException">The gateway refuses this client, or the address is wrong.</exception>
        public async Task RunAsync(CancellationToken cancellation)
        {
            Interlocked.Increment(ref _connects); // this method throws what a refusal says
            try
            {
                Connect();
                do
                {
                    Pump();
                    await Mailbox.WaitAsync(TickMilliseconds);
                }
                while (State != ConnectionState.Refused && !IsDisposed && !cancellation.IsCancellationRequested);
                if (State == ConnectionState.Refused)
                {
                    throw new GatewayException(_link.LastError);
                }
                Disconnect();
            }
            finally
            {
                Pump();
                Interlocked.Decrement(ref _connects);
            }
        }
    }
}
