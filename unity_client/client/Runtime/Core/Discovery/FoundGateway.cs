// SPDX-License-Identifier: Apache-2.0
using System;
using System.Net;
using System.Text;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>A gateway that has answered on this network.</summary>
    public sealed class FoundGateway
    {
        private const int MaxName = 63;
        private const int MaxPath = 200;

        private FoundGateway(string id, string name, string address, string secureAddress, bool needsToken) =>
            (Id, Name, Address, SecureAddress, NeedsToken) = (id, name, address, secureAddress, needsToken);

        /// <summary>The name of the gateway's machine.</summary>
        public string Name { get; private set; }

        /// <summary>For <see cref="GatewayOptions.Address"/>.</summary>
        public string Address { get; private set; }

        /// <summary>With TLS, if that has its own port. Else null.</summary>
        public string SecureAddress { get; private set; }

        /// <summary>Whether clients without a token are refused.</summary>
        public bool NeedsToken { get; private set; }

        /// <summary>Of one run of one gateway, which may be heard in several ways.</summary>
        internal string Id { get; private set; }

        /// <summary>The gateway that a datagram describes. Null if it is not a gateway's answer.</summary>
        internal static FoundGateway Read(byte[] datagram, int count, IPAddress sender)
        {
            JsonValue answer;
            try
            {
                answer = JsonValue.Parse(new UTF8Encoding(false, true).GetString(datagram, 0, count));
            }
            catch (Exception error) when (error is JsonFormatException or ArgumentException) // it is not UTF-8
            {
                return null;
            }
            string id = answer["id"].AsString();
            string name = answer["name"].AsString();
            string path = answer["path"].AsString();
            long port = answer["port"].AsLong();
            long securePort = answer["tls_port"].AsLong();
            if (answer["op"].AsString() != "gateway" || !IsPort(port) || id.Length == 0 || id.Length > MaxName
                || name.Length > MaxName || path.Length > MaxPath || !path.StartsWith("/", StringComparison.Ordinal))
            {
                return null;
            }
            string scheme = answer["tls"].AsBool() ? "wss" : "ws";
            return new FoundGateway(
                id,
                name,
                scheme + "://" + sender + ":" + port + path,
                IsPort(securePort) ? "wss://" + sender + ":" + securePort + path : null,
                answer["token"].AsBool());
        }

        private static bool IsPort(long number) => number > 0 && number < 65536;
    }
}
