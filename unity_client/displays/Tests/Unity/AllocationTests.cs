// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections;
using NUnit.Framework;
using Ros2Gateway.Messages.SensorMsgs;
using UnityEngine.TestTools;

namespace Ros2Gateway.Unity.Tests
{
    /// <summary>The allocations of a frame on the main thread, once everything has its size.</summary>
    [TestFixture]
    public sealed class AllocationTests
    {
        private const int WarmUp = 20; // messages
        private const int Measured = 50; // messages
        private const int Parts = 10;

        private DisplayScene _scene;

        [SetUp]
        public void SetUp()
        {
            long before = GC.GetAllocatedBytesForCurrentThread();
            GC.KeepAlive(new byte[1000]);
            if (GC.GetAllocatedBytesForCurrentThread() - before < 1000)
            {
                Assert.Ignore("this runtime does not count what a thread allocates");
            }
            _scene = new DisplayScene();
        }

        [TearDown]
        public void TearDown()
        {
            if (_scene != null)
            {
                _scene.Dispose();
            }
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator PumpingAndShowingPicturesAndScansAllocatesNothing()
        {
            GatewayConnection connection = _scene.Connect();
            ImageScreen screen = _scene.Display<ImageScreen>(
                "/camera/image_raw", "sensor_msgs/msg/Image", DisplayParts.OnRenderer);
            LaserScanDisplay scan = _scene.Display<LaserScanDisplay>("/scan", LaserScanMsg.Type);
            DigitalTwin twin = _scene.Display<DigitalTwin>("/odom", "nav_msgs/msg/Odometry");
            int pictures = 0;
            int scans = 0;
            int poses = 0;
            screen.Subscriber.MessageReceived += message => pictures++;
            scan.Subscriber.MessageReceived += message => scans++;
            twin.Subscriber.MessageReceived += message => poses++;
            // waiting allocates itself, so not in the part that is measured
            yield return _scene.Until(
                () => pictures >= WarmUp && scans >= WarmUp && poses >= WarmUp, "for messages of all kinds");
            yield return _scene.Until(() => connection.Client.RosClock.IsKnown, "for a ping");
            // a buffer that grows with a burst may grow again on a busy machine
            long allocated = -1;
            for (int part = 0; part < Parts && allocated != 0; part++)
            {
                pictures = scans = poses = 0;
                long before = GC.GetAllocatedBytesForCurrentThread();
                while (pictures < Measured || scans < Measured / 4 || poses < Measured)
                {
                    yield return null;
                }
                allocated = GC.GetAllocatedBytesForCurrentThread() - before;
            }
            Assert.AreEqual(
                0, allocated, "bytes in " + pictures + " pictures, " + scans + " scans, " + poses + " poses");
        }

        [UnityTest]
        public IEnumerator ShowingAPointCloudAllocatesNothing()
        {
            PointCloudDisplay display = _scene.Display<PointCloudDisplay>();
            display.Subscriber.StopAllCoroutines(); // after a while one warns that it has no connection
            PointCloud2Msg cloud = new()
            {
                width = 10000,
                height = 1,
                point_step = 12,
                data = new byte[120000],
                fields = new[]
                {
                    new PointFieldMsg { name = "x", datatype = PointFieldMsg.FLOAT32 },
                    new PointFieldMsg { name = "y", datatype = PointFieldMsg.FLOAT32, offset = 4 },
                    new PointFieldMsg { name = "z", datatype = PointFieldMsg.FLOAT32, offset = 8 },
                },
            };
            long before = 0;
            for (int i = 0; i < 2 * Measured; i++)
            {
                before = i == Measured ? GC.GetAllocatedBytesForCurrentThread() : before;
                display.Show(cloud);
                yield return null;
            }
            long allocated = GC.GetAllocatedBytesForCurrentThread() - before;
            Assert.AreEqual(10000, display.Drawn);
            Assert.AreEqual(0, allocated, "bytes in " + Measured + " clouds");
        }
    }
}
