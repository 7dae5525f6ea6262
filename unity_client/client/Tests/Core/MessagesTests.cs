// SPDX-License-Identifier: Apache-2.0
using System;
using System.Text;
using NUnit.Framework;
using Ros2Gateway.Json;
using Ros2Gateway.Messages;
using Ros2Gateway.Messages.BuiltinInterfaces;
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Messages.NavMsgs;
using Ros2Gateway.Messages.SensorMsgs;
using Ros2Gateway.Messages.StdMsgs;
using Ros2Gateway.Messages.StdSrvs;

namespace Ros2Gateway.Tests
{
    [TestFixture]
    public class MessagesTests
    {
        [Test]
        public void FieldsHaveTheNamesOfRos()
        {
            var odometry = new OdometryMsg();
            Read(odometry, "{\"pose\":{\"pose\":{\"position\":{\"x\":1.5}}},\"child_frame_id\":\"base\"}");
            Assert.AreEqual(1.5, odometry.pose.pose.position.x);
            Assert.AreEqual("base", odometry.child_frame_id);
            Assert.AreEqual(36, odometry.pose.covariance.Length);
        }

        [Test]
        public void FieldsThatAreAbsentStayAsTheyAre()
        {
            var twist = new TwistMsg();
            twist.linear.x = 1;
            Read(twist, "{\"angular\":{\"z\":2}}");
            Assert.AreEqual(1, twist.linear.x);
            Assert.AreEqual(2, twist.angular.z);
        }

        [Test]
        public void WhatWasForgottenIsWrittenAsEmpty()
        {
            var scan = new LaserScanMsg { header = null, ranges = null };
            string text = Written(scan);
            StringAssert.StartsWith("{\"header\":{},", text);
            StringAssert.Contains("\"ranges\":[]", text);
            Assert.AreEqual("{\"data\":\"\"}", Written(new StringMsg { data = null }));
            Assert.AreEqual("{\"goals\":[{}]}", Written(new Goals()));
        }

        [Test]
        public void AMessageThatIsNullIsMadeWhenItIsRead()
        {
            var pose = new PoseMsg { position = null };
            Read(pose, "{\"position\":{\"y\":3}}");
            Assert.AreEqual(3, pose.position.y);
        }

        [Test]
        public void AnArrayOfAFixedLengthIsCheckedWhenItIsWritten()
        {
            var pose = new PoseWithCovarianceMsg { covariance = new double[35] };
            InvalidOperationException error = Assert.Throws<InvalidOperationException>(() => Written(pose));
            Assert.AreEqual("covariance has 35 elements, must have 36", error.Message);
        }

        [Test]
        public void AStampThatNobodySetIsLeftOutSoThatTheGatewaySetsItAndOneOfZeroStays()
        {
            const string Zero = "{\"stamp\":{\"sec\":0,\"nanosec\":0},\"frame_id\":\"map\"}";
            const string Unset = "{\"frame_id\":\"map\"}";
            var header = new HeaderMsg { frame_id = "map" };
            Assert.AreEqual(Unset, Written(header));
            header.stamp.nanosec = 1;
            Assert.AreEqual("{\"stamp\":{\"sec\":0,\"nanosec\":1},\"frame_id\":\"map\"}", Written(header));
            header.stamp = null;
            Assert.AreEqual(Unset, Written(header));
            header.stamp = new TimeMsg();
            Assert.AreEqual(Zero, Written(header));
            foreach (string text in new[] { Zero, Unset })
            {
                var read = new HeaderMsg();
                Read(read, text);
                Assert.AreEqual(text, Written(read));
            }
        }

        [Test]
        public void ConstantsAndTypesAreThoseOfTheDefinition()
        {
            Assert.AreEqual(2, BatteryStateMsg.POWER_SUPPLY_STATUS_DISCHARGING);
            Assert.AreEqual("sensor_msgs/msg/BatteryState", BatteryStateMsg.Type);
            Assert.AreEqual("sensor_msgs/msg/BatteryState", new BatteryStateMsg().RosType);
            Assert.AreEqual("std_srvs/srv/SetBool_Request", new SetBoolRequest().RosType);
            Assert.AreEqual("std_srvs/srv/SetBool", SetBoolRequest.Service);
            Assert.AreEqual("std_srvs/srv/SetBool", SetBoolResponse.Service);
        }

        [TestCase("geometry_msgs/msg/Twist")]
        [TestCase("geometry_msgs/Twist")]
        [TestCase("1")]
        public void TheCatalogueMakesAMessageByNameAndNumber(string type)
        {
            MessageCatalogue.Register<TwistMsg>();
            Assert.IsInstanceOf<TwistMsg>(MessageCatalogue.Create(type));
            Assert.AreNotSame(MessageCatalogue.Create(type), MessageCatalogue.Create(type));
        }

        [TestCase(null)]
        [TestCase("")]
        [TestCase("Twist")]
        [TestCase("geometry_msgs/")]
        [TestCase("/")]
        [TestCase("geometry_msgs/msg/Twister")]
        [TestCase("geometry_msgs/msg/Wrench")]
        [TestCase("999")]
        [TestCase("01")]
        [TestCase("99999999999999999999")]
        public void TheCatalogueHasNothingForATypeThatNobodyRegistered(string type) =>
            Assert.IsNull(MessageCatalogue.Create(type));

        [Test]
        public void ARegisteredClassIsMadeByItsNameAndListedIfItIsAMessage()
        {
            MessageCatalogue.Register("own_msgs/msg/Thing", () => new DynamicMessage("own_msgs/msg/Thing"));
            MessageCatalogue.Register("own_msgs/srv/Do_Request", () => new DynamicMessage("own_msgs/srv/Do_Request"));
            Assert.AreEqual("own_msgs/msg/Thing", MessageCatalogue.Create("own_msgs/Thing").RosType);
            Assert.AreEqual("own_msgs/srv/Do_Request", MessageCatalogue.Create("own_msgs/srv/Do_Request").RosType);
            CollectionAssert.Contains(MessageCatalogue.Types, "own_msgs/msg/Thing");
            CollectionAssert.DoesNotContain(MessageCatalogue.Types, "own_msgs/srv/Do_Request");
            CollectionAssert.IsOrdered(MessageCatalogue.Types, System.StringComparer.Ordinal);
        }

        [Test]
        public void TheFirstClassThatIsRegisteredForATypeStays()
        {
            MessageCatalogue.Register("own_msgs/msg/Twice", () => new DynamicMessage("own_msgs/msg/Twice"));
            MessageCatalogue.Register("own_msgs/msg/Twice", () => new TwistMsg());
            Assert.IsInstanceOf<DynamicMessage>(MessageCatalogue.Create("own_msgs/msg/Twice"));
        }

        [Test]
        public void ARegistrationWithoutTypeOrClassIsRefused()
        {
            Assert.Throws<ArgumentException>(() => MessageCatalogue.Register("", () => new TwistMsg()));
            Assert.Throws<ArgumentNullException>(() => MessageCatalogue.Register("own_msgs/msg/Nothing", null));
        }

        [Test]
        public void TheCatalogueListsTheTypesOfThePackageAndATreeIsNone()
        {
            Assert.Greater(MessageCatalogue.Types.Count, 100);
            CollectionAssert.Contains(MessageCatalogue.Types, "geometry_msgs/msg/Wrench");
            MessageCatalogue.Register<DynamicMessage>();
            CollectionAssert.DoesNotContain(MessageCatalogue.Types, "");
        }

        private static void Read(IMessage message, string text)
        {
            byte[] utf8 = Encoding.UTF8.GetBytes(text);
            var reader = new JsonReader();
            reader.Reset(utf8, 0, utf8.Length);
            message.Read(reader);
            reader.End();
        }

        private static string Written(IMessage message)
        {
            var writer = new JsonWriter();
            message.Write(writer);
            return writer.ToString();
        }

        /// <summary>A message class of an application, which the catalogue does not know.</summary>
        private sealed class Goals : IMessage
        {
            public string RosType => "some_msgs/msg/Goals";

            public void Read(JsonReader reader) => reader.Skip();

            public void Write(JsonWriter writer)
            {
                writer.BeginObject();
                writer.Name("goals");
                NestedMessages.Write(writer, new PoseMsg[] { null });
                writer.EndObject();
            }
        }
    }
}
