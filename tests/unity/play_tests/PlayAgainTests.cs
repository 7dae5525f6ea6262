// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections;
using System.Diagnostics;
using NUnit.Framework;
using Ros2Gateway.Messages.NavMsgs;
using Ros2Gateway.Thesis;
using Ros2Gateway.Unity;
using UnityEngine;
using UnityEngine.Stage;
using UnityEngine.TestTools;
using Object = UnityEngine.Object;

namespace Ros2Gateway.Play.Tests
{
    /// <summary>
    /// Play after Play where the editor reloads neither scripts nor scene: objects and static state stay.
    /// </summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class PlayAgainTests
    {
        private const int TimeoutMilliseconds = 120000; // a machine may be busy with other things

        private static string Address
        {
            get { return Environment.GetEnvironmentVariable("ROS2GATEWAY_TEST_URL"); }
        }

        [UnityTest]
        public IEnumerator Components_work_in_every_Play()
        {
            GameObject holder = new GameObject("scene");
            holder.SetActive(false);
            TopicSubscriber subscriber = holder.AddComponent<TopicSubscriber>();
            subscriber.Topic = "/odom";
            subscriber.Type = OdometryMsg.Type;
            TeleopDriver driver = holder.AddComponent<TeleopDriver>();
            GatewayConnection connection = holder.AddComponent<GatewayConnection>();
            connection.Address = Address;
            holder.SetActive(true);
            for (int i = 0; i < 3; i++)
            {
                GatewayClient client = connection.Client;
                IMessage last = subscriber.Last;
                yield return Until(() => !ReferenceEquals(subscriber.Last, last), "for odometry in Play " + i);
                yield return Until(() => driver.CommandType != null, "for the robot in Play " + i);
                PlayerLoop.PlayAgain();
                Assert.IsTrue(client.IsDisposed);
            }
            Object.DestroyImmediate(holder);
        }

        [UnityTest]
        public IEnumerator The_library_of_old_ends_with_the_Play()
        {
            PlayerLoop.BeginPlay();
            yield return Connected();
            PlayerLoop.Quit();
            Assert.IsFalse(Ros2Library.ros2_ok(), "it lives on in Edit mode");
            yield return Connected();
            PlayerLoop.BeginPlay(); // after one that was not left in order
            Assert.IsFalse(Ros2Library.ros2_ok(), "it lives on in the next Play");
        }

        private static IEnumerator Connected()
        {
            Ros2Library.Options = new GatewayOptions { Address = Address };
            Ros2Library.ros2_init();
            return Until(Ros2Library.ros2_ok, "to be connected");
        }

        private static IEnumerator Until(Func<bool> holds, string what)
        {
            Stopwatch watch = Stopwatch.StartNew();
            while (!holds())
            {
                Assert.Less(watch.ElapsedMilliseconds, TimeoutMilliseconds, "waited in vain " + what);
                yield return null;
            }
        }
    }
}
