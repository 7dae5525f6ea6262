// SPDX-License-Identifier: Apache-2.0
using System.Threading;
using Ros2Gateway;
using Ros2Gateway.Messages.StdMsgs;

/// <summary>Publishes on one topic what it hears on another, whenever there is a gateway.</summary>
internal static class Echo
{
    private static void Main(string[] arguments)
    {
        GatewayOptions options = new GatewayOptions
        {
            Address = arguments[0],
            FirstPauseMilliseconds = 100,
            LongestPauseMilliseconds = 1000,
        };
        using (GatewayClient client = new GatewayClient(options))
        {
            Publisher<StringMsg> publisher = client.Advertise<StringMsg>(arguments[2]);
            client.Subscribe<StringMsg>(arguments[1], message => publisher.Publish(message));
            client.Connect();
            while (true)
            {
                client.Pump();
                Thread.Sleep(5);
            }
        }
    }
}
