// SPDX-License-Identifier: Apache-2.0
using System;
using System.Threading;
using System.Threading.Tasks;
using NUnit.Framework;
using Ros2Gateway.Messages.NavMsgs;
using Ros2Gateway.Messages.StdSrvs;

namespace Ros2Gateway.Tests
{
    /// <summary>
    /// A program without frames: the client pumps itself. On threads of the pool, as nothing there expects a caller back
    /// on the thread of the test.
    /// </summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class RunTests
    {
        [TestCase(true)]
        [TestCase(false)]
        public void ItConnectsAndCallsHandlersUntilItsTokenIsCancelled(bool usesThreads)
        {
            using (Live live = new(Live.Gateway, "", options => options.UsesThreads = usesThreads))
            using (CancellationTokenSource end = new())
            {
                TaskCompletionSource<OdometryMsg> heard = new();
                live.Client.Subscribe<OdometryMsg>("/odom", odometry => heard.TrySetResult(odometry));
                Task run = Task.Run(() => live.Client.RunAsync(end.Token));
                Ends(Task.Run(() => Ask(live.Client)));
                Ends(heard.Task);
                Assert.IsFalse(run.IsCompleted);
                end.Cancel();
                Ends(run);
                Assert.AreEqual(ConnectionState.Disconnected, live.Client.State);
                Assert.AreEqual(ConnectionState.Disconnected, live.States[live.States.Count - 1], "it is told");
            }
        }

        [Test]
        public void ItFailsWithTheWordsOfARefusalAndLogsNoError()
        {
            using Live live = new(Live.Rogue, "/refuses");
            AggregateException error = Assert.Throws<AggregateException>(
                () => Ends(Task.Run(() => live.Client.RunAsync(CancellationToken.None))));
            Assert.IsInstanceOf<GatewayException>(error.InnerException);
            StringAssert.Contains("the token is wrong", error.InnerException.Message);
            Assert.IsTrue(live.Heard("the token is wrong"));
            Assert.IsFalse(live.Events.Exists(one => one.Level == EventLevel.Error));
        }

        [Test]
        public void ItEndsWithItsClient()
        {
            Live live = new(Live.Gateway);
            Task run = Task.Run(() => live.Client.RunAsync(CancellationToken.None));
            live.Dispose();
            Ends(run);
        }

        private static async Task Ask(GatewayClient client)
        {
            await client.ConnectAsync();
            RosGraph graph = await client.GetGraphAsync();
            while (graph.ServiceType("/motor_power").Length == 0)
            {
                graph = await client.GetGraphAsync(); // the gateway may just have started
            }
            await client.CallServiceAsync<SetBoolResponse>("/motor_power", new SetBoolRequest { data = true });
        }

        private static void Ends(Task task) => Assert.IsTrue(task.Wait(Live.TimeoutMilliseconds));
    }
}
