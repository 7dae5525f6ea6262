// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>A ROS service that this client provides. It survives reconnections and ends with Dispose.</summary>
    public abstract class ServiceProvider : IDisposable
    {
        private readonly ServiceProviders _providers;

        internal ServiceProvider(ServiceProviders providers, string service, string type)
        {
            _providers = providers;
            Service = service;
            Type = type;
        }

        /// <summary>The service, with its leading slash.</summary>
        public string Service { get; private set; }

        /// <summary>pkg/srv/Name.</summary>
        public string Type { get; private set; }

        /// <summary>Provides it no longer.</summary>
        public void Dispose()
        {
            _providers.Remove(this);
        }

        /// <summary>Reads a request. Returns how to answer it, which is for the application's thread.</summary>
        internal abstract Action<string> Read(JsonReader reader);

        internal void Answer(string id, IMessage response)
        {
            _providers.Answer(this, id, response);
        }
    }

    internal sealed class ServiceProvider<TRequest, TResponse> : ServiceProvider
        where TRequest : IMessage, new()
        where TResponse : IMessage
    {
        private readonly Func<TRequest, TResponse> _handler;

        internal ServiceProvider(
            ServiceProviders providers, string service, string type, Func<TRequest, TResponse> handler)
            : base(providers, service, type)
        {
            _handler = handler;
        }

        internal override Action<string> Read(JsonReader reader)
        {
            TRequest request = new TRequest();
            request.Read(reader);
            return id =>
            {
                TResponse response = _handler(request);
                if (response == null)
                {
                    throw new InvalidOperationException("the handler of " + Service + " returned null: return a response");
                }
                Answer(id, response);
            };
        }
    }
}
