// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections;
using System.Diagnostics;
using NUnit.Framework;
using Ros2Gateway.Messages.StdSrvs;
using UnityEngine;

namespace Ros2Gateway.Samples.Tests
{
    /// <summary>One of the demonstrations, as someone starts it: its builder on an empty object.</summary>
    internal sealed class DemoScene : IDisposable
    {
        private const int TimeoutMilliseconds = 120000; // a machine may be busy with other things

        internal readonly GameObject Root = new GameObject("demonstration");

        internal DemoScene()
        {
            Root.SetActive(false);
        }

        internal static string Address
        {
            get
            {
                string address = Environment.GetEnvironmentVariable("ROS2GATEWAY_TEST_URL");
                if (string.IsNullOrEmpty(address))
                {
                    Assert.Ignore("needs a gateway: set ROS2GATEWAY_TEST_URL");
                }
                return address;
            }
        }

        internal T Add<T>()
            where T : Component
        {
            return Root.AddComponent<T>();
        }

        internal void Begin()
        {
            Root.SetActive(true);
        }

        internal IEnumerator Until(Func<bool> holds, string what)
        {
            Stopwatch watch = Stopwatch.StartNew();
            while (!holds())
            {
                Assert.Less(watch.ElapsedMilliseconds, TimeoutMilliseconds, "waited in vain " + what);
                yield return null;
            }
        }

        /// <summary>Puts the simulated robot back to its start, and waits until its twin is there.</summary>
        internal IEnumerator Reset(GatewayClient client, Transform twin)
        {
            bool isReset = false;
            client.CallService<TriggerResponse>("/reset", new TriggerRequest(), reply => isReset = reply.Ok);
            yield return Until(() => isReset, "for an answer of /reset");
            yield return Until(() => twin.localPosition.magnitude < 0.01f, "for the twin to be at the start");
        }

        public void Dispose()
        {
            // The camera may be the main one: of these tests it is the demonstration's own.
            UnityEngine.Object.DestroyImmediate(Root);
        }
    }
}
