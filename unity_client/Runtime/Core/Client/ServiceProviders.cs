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

        private readonly object _gate = new object();
        private readonly Outbox _outbox;
        private readonly Mailbox _mailbox;
        private readonly Dictionary<string, ServiceProvider> _byService = new Dictionary<string, ServiceProvider>();
        private int _waiting;
        private long _connection; // counts them

        internal ServiceProviders(Outbox outbox, Mailbox mailbox)
        {
            _outbox = outbox;
            _mailbox = mailbox;
        }

        internal void Add(ServiceProvider provider)
        {
            lock (_gate)
            {
                _byService[provider.Service] = provider;
                Send("advertise_service", provider);
            }
        }

        internal void Remove(ServiceProvider provider)
        {
            lock (_gate)
            {
                ServiceProvider current;
                if (!_byService.TryGetValue(provider.Service, out current) || current != provider)
                {
                    return;
                }
                _byService.Remove(provider.Service);
                Send("unadvertise_service", provider);
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
                    Send("advertise_service", provider);
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
            Action<string> answer;
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
            _mailbox.Post("service " + service, () => Run(provider, connection, id, answer));
        }

        internal void Answer(ServiceProvider provider, string id, IMessage response)
        {
            JsonWriter frame = Begin(provider.Service, id);
            frame.Name("values");
            response.Write(frame);
            frame.Member("result", true);
            frame.EndObject();
            string refusal = _outbox.Post(frame);
            if (refusal != null && refusal != Outbox.NotConnected)
            {
                Refuse(provider.Service, id, refusal);
            }
        }

        private void Run(ServiceProvider provider, long connection, string id, Action<string> answer)
        {
            Done();
            lock (_gate)
            {
                ServiceProvider current;
                if (connection != _connection
                    || !_byService.TryGetValue(provider.Service, out current) || current != provider)
                {
                    return; // its caller has been answered by the gateway
                }
            }
            try
            {
                answer(id);
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

        private void Refuse(string service, string id, string errorText)
        {
            JsonWriter frame = Begin(service, id);
            frame.Member("values", errorText);
            frame.Member("result", false);
            frame.EndObject();
            _outbox.Post(frame);
        }

        private JsonWriter Begin(string service, string id)
        {
            JsonWriter frame = _outbox.Rent();
            frame.Begin("service_response", id);
            frame.Member("service", service);
            return frame;
        }

        private void Send(string op, ServiceProvider provider)
        {
            JsonWriter frame = _outbox.Rent();
            frame.Begin(op);
            frame.Member("service", provider.Service);
            if (op == "advertise_service")
            {
                frame.Member("type", provider.Type);
            }
            frame.EndObject();
            _outbox.Post(frame);
        }
    }
}
