// SPDX-License-Identifier: Apache-2.0
using NUnit.Framework;
using Ros2Gateway.Json;
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Messages.NavMsgs;
using Ros2Gateway.Messages.SensorMsgs;
using Ros2Gateway.Messages.StdMsgs;

namespace Ros2Gateway.Tests
{
    [TestFixture]
    public sealed class MessageTextTests
    {
        [Test]
        public void FieldsAreLinesIndentedAsTheyAreNested()
        {
            PointStampedMsg message = new();
            message.header.stamp.sec = 1700000000;
            message.header.frame_id = "map";
            message.point.x = 0.1 + 0.2;
            message.point.y = double.NaN;
            message.point.z = -12;
            Assert.AreEqual(
                "header:\n  stamp:\n    sec: 1700000000\n    nanosec: 0\n  frame_id: map\n"
                + "point:\n  x: 0.3\n  y: nan\n  z: -12",
                Text(message));
        }

        [Test]
        public void AMessageThatIsOnlyDataIsItsValue()
        {
            Assert.AreEqual("hello <b>\nworld", Text(new StringMsg { data = "hello <b>\nworld" }));
            Assert.AreEqual("true", Text(new BoolMsg { data = true }));
            Assert.AreEqual("", Text(new StringMsg()));
            Assert.AreEqual("", Text(new EmptyMsg()));
        }

        [Test]
        public void LongArraysAreShortened()
        {
            LaserScanMsg scan = new() { ranges = new float[720] };
            scan.ranges[0] = 0.1f;
            scan.ranges[1] = float.PositiveInfinity;
            scan.intensities = new float[] { 1, float.NaN, 3 };
            string text = Text(scan);
            StringAssert.Contains("ranges: [0.1, Infinity, ... 720]\n", text);
            StringAssert.EndsWith("intensities: [1, nan, 3]", text);
        }

        [Test]
        public void OfArraysOfMessagesTheFirstAreShown()
        {
            PathMsg path = new() { poses = new PoseStampedMsg[5] };
            for (int i = 0; i < path.poses.Length; i++)
            {
                path.poses[i] = new PoseStampedMsg();
                path.poses[i].pose.position.x = i;
            }
            string text = new MessageText(100).Of(path);
            StringAssert.Contains("poses:\n  [0]:\n    header:", text);
            StringAssert.Contains("\n        x: 2\n", text);
            StringAssert.DoesNotContain("[3]", text);
            StringAssert.EndsWith("\n  ... 5", text);
        }

        [Test]
        public void BinaryDataAreTheirSize()
        {
            CompressedImageMsg picture = new() { format = "jpeg", data = new byte[1000] };
            StringAssert.EndsWith("format: jpeg\ndata: 1000 bytes", Text(picture));
        }

        [Test]
        public void LongTextsAreCutAndSayHowLongTheyAre()
        {
            string text = Text(new HeaderMsg { frame_id = new string('-', 5000) });
            StringAssert.EndsWith(new string('-', 200) + "... 5000 characters", text);
            Assert.Less(text.Length, 300);
        }

        [Test]
        public void ThereAreNotMoreLinesThanAskedFor()
        {
            string[] lines = new MessageText(4).Of(new OdometryMsg()).Split('\n');
            Assert.AreEqual(5, lines.Length);
            Assert.AreEqual("...", lines[4]);
            Assert.AreEqual("a\nb\n...", new MessageText(2).Of(new StringMsg { data = "a\nb\nc\nd" }));
        }

        [Test]
        public void LineBreaksInAFieldStayInItsLine() =>
            StringAssert.EndsWith("frame_id: a\\nb", Text(new HeaderMsg { frame_id = "a\nb" }));

        [Test]
        public void TreesAndWhatCannotBeWrittenAreTextToo()
        {
            DynamicMessage tree = new("a/msg/B");
            tree.Value = JsonValue.Parse(
                "{\"a\":[],\"b\":[[1,2],[3]],\"c\":{},\"d\":null,\"e\":[\"x\",true]}");
            Assert.AreEqual(
                "a: []\nb:\n  [0]: [1, 2]\n  [1]: [3]\nc:\nd: nan\ne: [x, true]", Text(tree));
            OdometryMsg odometry = new();
            odometry.pose.covariance = new double[3];
            StringAssert.Contains("covariance", Text(odometry));
        }

        [Test]
        public void AWriterIsUsedAgain()
        {
            MessageText writer = new();
            writer.Of(new OdometryMsg());
            Assert.AreEqual("again", writer.Of(new StringMsg { data = "again" }));
        }

        private static string Text(IMessage message) => new MessageText().Of(message);
    }
}
