// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections;
using System.Collections.Generic;
using System.Diagnostics;
using NUnit.Framework;
using UnityEngine;
using Object = UnityEngine.Object;

namespace Ros2Gateway.Unity.Tests
{
    /// <summary>Displays on their own objects, with a connection to the gateway on demand.</summary>
    public sealed class DisplayScene : IDisposable
    {
        public const string Gateway = "ROS2GATEWAY_TEST_URL";

        private const int TimeoutMilliseconds = 120000; // a machine may be busy with other things

        /// <summary>The log, of any level.</summary>
        public readonly List<string> Logged = new();

        private readonly List<Object> _made = new();

        public DisplayScene() => Application.logMessageReceived += Log;

        public GatewayConnection Connection { get; private set; }

        /// <summary>Adds a connection, which connects at once.</summary>
        public GatewayConnection Connect(Action<GatewayConnection> setUp = null)
        {
            string address = Environment.GetEnvironmentVariable(Gateway);
            if (string.IsNullOrEmpty(address))
            {
                Assert.Ignore("needs a gateway: set " + Gateway);
            }
            GatewaySettings settings = ScriptableObject.CreateInstance<GatewaySettings>();
            settings.Address = address;
            settings.SilenceSeconds = TimeoutMilliseconds / 1000; // a busy machine holds the gateway up
            _made.Add(settings);
            GameObject holder = Inactive("connection");
            Connection = holder.AddComponent<GatewayConnection>();
            Connection.Settings = settings;
            if (setUp != null)
            {
                setUp(Connection);
            }
            holder.SetActive(true);
            return Connection;
        }

        /// <summary>Another program, whose messages a busy machine may hold up. Connect and dispose it.</summary>
        public GatewayClient OtherProgram() =>
            new GatewayClient(new GatewayOptions
            {
                Address = Connection.Settings.Address,
                FreshMilliseconds = TimeoutMilliseconds,
            });

        /// <summary>An object that is not active yet, so that components on it can be set up.</summary>
        public GameObject Inactive(string name)
        {
            GameObject made = new(name);
            made.SetActive(false);
            _made.Add(made);
            return made;
        }

        /// <summary>A display with its subscriber, active unless *setUp* is to come.</summary>
        public T Display<T>(string topic = "/nowhere", string type = "", Action<T> setUp = null)
            where T : Component
        {
            GameObject holder = Inactive(typeof(T).Name);
            T display = holder.AddComponent<T>();
            TopicSubscriber subscriber = holder.GetComponent<TopicSubscriber>();
            if (subscriber != null)
            {
                subscriber.Topic = topic;
                subscriber.Type = type;
            }
            if (setUp != null)
            {
                setUp(display);
            }
            holder.SetActive(true);
            return display;
        }

        /// <summary>A publisher of the scene's connection.</summary>
        public TopicPublisher Publisher(string topic, string type, Action<TopicPublisher> setUp = null)
        {
            GameObject holder = Inactive("publisher");
            TopicPublisher publisher = holder.AddComponent<TopicPublisher>();
            publisher.Topic = topic;
            publisher.Type = type;
            if (setUp != null)
            {
                setUp(publisher);
            }
            holder.SetActive(true);
            return publisher;
        }

        /// <summary>Frames until something holds.</summary>
        public IEnumerator Until(Func<bool> holds, string what, Action again = null)
        {
            Stopwatch watch = Stopwatch.StartNew();
            while (true)
            {
                if (again != null)
                {
                    again();
                }
                if (holds())
                {
                    yield break;
                }
                if (watch.ElapsedMilliseconds > TimeoutMilliseconds)
                {
                    Assert.Fail("waited in vain " + what + "; logged: " + string.Join(" | ", Logged));
                }
                yield return null;
            }
        }

        public bool HasLogged(string words) => Logged.Exists(text => text.Contains(words));

        public void Dispose()
        {
            for (int i = _made.Count - 1; i >= 0; i--)
            {
                Object.DestroyImmediate(_made[i]);
            }
            Application.logMessageReceived -= Log;
        }

        private void Log(string text, string stackTrace, LogType type) => Logged.Add(text);
    }
}
