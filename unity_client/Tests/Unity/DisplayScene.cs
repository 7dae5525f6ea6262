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
    internal sealed class DisplayScene : IDisposable
    {
        internal const string Gateway = "ROS2GATEWAY_TEST_URL";

        private const int TimeoutMilliseconds = 120000; // a machine may be busy with other things

        /// <summary>The log, of any level.</summary>
        internal readonly List<string> Logged = new List<string>();

        private readonly List<Object> _made = new List<Object>();

        internal DisplayScene()
        {
            Application.logMessageReceived += Log;
        }

        internal GatewayConnection Connection { get; private set; }

        /// <summary>Adds a connection, which connects at once.</summary>
        internal GatewayConnection Connect(Action<GatewayConnection> setUp = null)
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
        internal GatewayClient OtherProgram()
        {
            return new GatewayClient(new GatewayOptions
            {
                Address = Connection.Settings.Address,
                FreshMilliseconds = TimeoutMilliseconds,
            });
        }

        /// <summary>An object that is not active yet, so that components on it can be set up.</summary>
        internal GameObject Inactive(string name)
        {
            GameObject made = new GameObject(name);
            made.SetActive(false);
            _made.Add(made);
            return made;
        }

        /// <summary>A display with its subscriber, active unless *setUp* is to come.</summary>
        internal T Display<T>(string topic = "/nowhere", string type = "", Action<T> setUp = null)
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
        internal TopicPublisher Publisher(string topic, string type, Action<TopicPublisher> setUp = null)
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

        /// <summary>The origin of a frame, for what is put below it. Needs a connection.</summary>
        internal FixedFrame Fixed(string frame)
        {
            GameObject holder = Inactive("fixed");
            FixedFrame made = holder.AddComponent<FixedFrame>();
            made.Frame = frame;
            holder.SetActive(true);
            return made;
        }

        /// <summary>Frames until something holds.</summary>
        internal IEnumerator Until(Func<bool> holds, string what, Action again = null)
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

        internal bool HasLogged(string words)
        {
            return Logged.Exists(text => text.Contains(words));
        }

        /// <summary>Gives an image screen something to show pictures on.</summary>
        internal static void OnRenderer(ImageScreen screen)
        {
            screen.gameObject.AddComponent<MeshRenderer>();
        }

        public void Dispose()
        {
            for (int i = _made.Count - 1; i >= 0; i--)
            {
                Object.DestroyImmediate(_made[i]);
            }
            Application.logMessageReceived -= Log;
        }

        private void Log(string text, string stackTrace, LogType type)
        {
            Logged.Add(text);
        }
    }
}
