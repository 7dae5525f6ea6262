// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections;
using System.Threading;
using System.Threading.Tasks;
using NUnit.Framework;
using Ros2Gateway.Messages.GeometryMsgs;
using UnityEngine;
using UnityEngine.TestTools;

namespace Ros2Gateway.Unity.Tests
{
    /// <summary>A component that awaits may use Unity's objects after it, and ends with the scene.</summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class AwaitComponentTests
    {
        private DisplayScene _scene;

        [SetUp]
        public void SetUp() => _scene = new DisplayScene();

        [TearDown]
        public void TearDown() => _scene.Dispose();

        [UnityTest]
        public IEnumerator WhatIsAwaitedGoesOnOnTheMainThread()
        {
            Follower follower = Follow("base_scan");
            yield return _scene.Until(() => follower.End != null, "for the transform");
            Assert.AreEqual("placed", follower.End);
            Assert.AreEqual(0.122f, follower.transform.localPosition.y, 1e-5f);
        }

        [UnityTest]
        public IEnumerator WhoAwaitsTheConnectionGoesOnWaitingWhileTheApplicationIsPaused()
        {
            GatewayConnection connection = _scene.Connect();
            Task connected = connection.Client.ConnectAsync();
            connection.SendMessage("OnApplicationPause", true);
            Assert.AreEqual(ConnectionState.Disconnected, connection.Client.State);
            yield return null;
            Assert.IsFalse(connected.IsCompleted);
            connection.SendMessage("OnApplicationPause", false);
            yield return _scene.Until(() => connected.IsCompleted, "to be connected");
            Assert.IsNull(connected.Exception);
            Assert.IsTrue(connection.Client.IsConnected);
        }

        [UnityTest]
        public IEnumerator WhoAwaitsTheConnectionIsToldThatItIsDisabledBeItInAPause([Values(false, true)] bool isPaused)
        {
            GatewayConnection connection = _scene.Connect();
            Task connected = connection.Client.ConnectAsync();
            if (isPaused)
            {
                connection.SendMessage("OnApplicationPause", true);
            }
            connection.enabled = false;
            yield return _scene.Until(() => connected.IsCompleted, "for the end", () => connection.Client.Pump());
            StringAssert.Contains("Disconnect was called", connected.Exception.InnerException.Message);
        }

        [UnityTest]
        public IEnumerator WhatAwaitsEndsWithItsObject()
        {
            Follower follower = Follow("a_frame_that_never_comes");
            GatewayClient client = follower.Connection.Client;
            yield return _scene.Until(() => client.PendingRequests > 0, "for it to be asked");
            UnityEngine.Object.Destroy(follower.gameObject);
            yield return _scene.Until(() => follower.End != null, "for the end");
            Assert.AreEqual("cancelled", follower.End);
            Assert.IsTrue(client.IsConnected);
            Assert.AreEqual(0, client.PendingRequests);
        }

        private Follower Follow(string frame)
        {
            GameObject made = _scene.Inactive("follower");
            Follower follower = made.AddComponent<Follower>();
            follower.Connection = _scene.Connect();
            follower.Frame = frame;
            made.SetActive(true);
            return follower;
        }

        /// <summary>Goes where a frame of the robot is.</summary>
        private sealed class Follower : MonoBehaviour
        {
            internal GatewayConnection Connection;
            internal string Frame;
            internal string End;

            private readonly CancellationTokenSource _destroyed = new();

            private async void Start()
            {
                try
                {
                    await Connection.Client.ConnectAsync(_destroyed.Token);
                    TransformStampedMsg found = await Connection.Client.LookupTransformAsync(
                        "base_link", Frame, _destroyed.Token, 60000);
                    transform.localPosition = found.transform.translation.As<Flu>().ToUnity();
                    End = "placed";
                }
                catch (OperationCanceledException)
                {
                    End = "cancelled";
                }
                catch (Exception error)
                {
                    End = error.Message;
                }
            }

            private void OnDestroy() => _destroyed.Cancel();
        }
    }
}
