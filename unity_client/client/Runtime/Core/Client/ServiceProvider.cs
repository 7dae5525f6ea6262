// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>A ROS service that this client provides. It survives reconnections and ends with Dispose.</summary>
    public sealed class ServiceProvider : IDisposable
    {
        private readonly ServiceProviders _providers;

        /// <param name="read">Reads a request. Returns how to get the response, which is for the application's thread.</param>
        internal ServiceProvider(
            ServiceProviders providers, string service, string type, Func<JsonReader, Func<IMessage>> read)
        {
            _providers = providers;
            Read = read;
            Service = service;
            Type = type;
        }

        /// <summary>The service, with its leading slash.</summary>
        public string Service { get; private set; }

        /// <summary>pkg/srv/Name.</summary>
        public string Type { get; private set; }

        /// <summary>Provides it no longer.</summary>
        public void Dispose() => _providers.Remove(this);

        internal Func<JsonReader, Func<IMessage>> Read { get; }
    }
}
