// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>All services that a client provides.</summary>
    internal sealed class ServiceProviders
    {
        // An application that is pumped at 60 Hz answers these within a frame. A ROS caller that finds
        // more of them waiting is better told so at once.
        private const int MaxWaiting = 64;

        private readonly object _gate = new();
        private readonly GatewayClient _client;
        private readonly Dictionary<string, ServiceProvider> _byService = new();
        private int _waiting;
        private long _connection; // counts them

        internal ServiceProviders(GatewayClient client) => _client = client;

        internal void Add(ServiceProvider provider)
        {
            lock (_gate)
            {
                _byService[provider.Service] = provider;
                Advertise(provider);
            }
        }

        internal void Remove(ServiceProvider provider)
        {
            lock (_gate)
            {
                if (!_byService.TryGetValue(provider.Service, out ServiceProvider current) || current != provider)
                {
                    return;
                }
                _byService.Remove(provider.Service);
                _client.Outbox.Send("unadvertise_service", null, frame => frame.Name("service").Value(provider.Service));
            }
        }

        /// <summary>Calls that wait are of a connection that is gone: their ids mean nothing on the next.</summary>
        internal void OnDown()
        {
            lock (_gate)
            {
                _connection++;
            }
        }

        internal void Restore()
        {
            lock (_gate)
            {
                foreach (ServiceProvider provider in _byService.Values)
                {
                    Advertise(provider);
                }
            }
        }

        /// <summary>A call has come from ROS. *Reader* stands before its arguments.</summary>
        internal void OnCall(string service, string id, JsonReader reader)
        {
            ServiceProvider provider;
            long connection;
            lock (_gate)
            {
                connection = _connection;
                if (!_byService.TryGetValue(service, out provider))
                {
                    Refuse(service, id, "service " + service + " is not provided any more");
                    return;
                }
                if (_waiting >= MaxWaiting)
                {
                    Refuse(service, id, "at most " + MaxWaiting + " calls wait for the application");
                    return;
                }
                _waiting++;
            }
            Func<IMessage> answer;
            try
            {
                answer = provider.Read(reader);
            }
            catch (Exception error)
            {
                // Not only a JsonFormatException: the message may be a class of the application's.
                Done();
                Refuse(service, id, "request cannot be read: " + error.Message);
                return;
            }
            _client.Mailbox.Post("service " + service, () => Run(provider, connection, id, answer));
        }

        private void Run(ServiceProvider provider, long connection, string id, Func<IMessage> answer)
        {
            Done();
            lock (_gate)
            {
                if (connection != _connection
                    || !_byService.TryGetValue(provider.Service, out ServiceProvider current) || current != provider)
                {
                    return; // its caller has been answered by the gateway
                }
            }
            try
            {
                IMessage response = answer()
                    ?? throw new InvalidOperationException(
                        "the handler of " + provider.Service + " returned null: return a response");
                string refusal = Respond(provider.Service, id, true, frame => response.Write(frame.Name("values")));
                if (refusal != null && refusal != Outbox.NotConnected)
                {
                    Refuse(provider.Service, id, refusal);
                }
            }
            catch (Exception error)
            {
                // The caller gets an answer whatever the application's handler does. The pump tells the rest.
                Refuse(provider.Service, id, error.Message);
                throw;
            }
        }

        private void Done()
        {
            lock (_gate)
            {
                _waiting--;
            }
        }

        private void Refuse(string service, string id, string errorText) =>
            Respond(service, id, false, frame => frame.Name("values").Value(errorText));

        private string Respond(string service, string id, bool result, Action<JsonWriter> values) =>
            _client.Outbox.Send("service_response", id, frame =>
            {
                frame.Name("service").Value(service);
                values(frame);
                frame.Name("result").Value(result);
            });

        private void Advertise(ServiceProvider provider) => _client.Outbox.Send("advertise_service", null, frame =>
        {
            frame.Name("service").Value(provider.Service);
            frame.Name("type").Value(provider.Type);
        });
    }
}
