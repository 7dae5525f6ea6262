// SPDX-License-Identifier: Apache-2.0
using NUnit.Framework;
using Ros2Gateway.Messages.GeometryMsgs;

namespace Ros2Gateway.Tests
{
    [TestFixture]
    public class MessageCoordinatesTests
    {
        [Test]
        public void APoseMessageGoesToUnityAndBack()
        {
            var message = new PoseMsg();
            message.position.x = 1;
            message.position.y = 2;
            message.position.z = 3;
            message.orientation.z = 0.6;
            message.orientation.w = 0.8;

            Pose<Ruf> unity = message.As<Flu>().To<Ruf>();
            Assert.AreEqual(new Vector3<Ruf>(-2, 3, 1), unity.position);
            Assert.AreEqual(new Quaternion<Ruf>(0, -0.6, 0, 0.8), unity.orientation);

            PoseMsg back = unity.To<Flu>().ToPoseMsg();
            Assert.AreEqual(message.As<Flu>(), back.As<Flu>());
        }

        [Test]
        public void ATransformMessageIsAPose()
        {
            var pose = new Pose<Flu>(new Vector3<Flu>(1, 2, 3), new Quaternion<Flu>(0, 0.6, 0, 0.8));
            TransformMsg message = pose.ToTransformMsg();
            Assert.AreEqual(2, message.translation.y);
            Assert.AreEqual(0.6, message.rotation.y);
            Assert.AreEqual(pose, message.As<Flu>());
        }

        [Test]
        public void ATwistHasAPolarAndAnAxialPart()
        {
            var linear = new Vector3<Ruf>(0, 0, 0.26);
            var angular = new AxialVector3<Ruf>(0, 1.82, 0);
            TwistMsg message = MessageCoordinates.ToTwistMsg(linear.To<Flu>(), angular.To<Flu>());
            Assert.AreEqual(0.26, message.linear.x);
            Assert.AreEqual(-1.82, message.angular.z);
            Assert.AreEqual(linear, message.linear.As<Flu>().To<Ruf>());
            Assert.AreEqual(angular, message.angular.AsAxial<Flu>().To<Ruf>());
        }

        [Test]
        public void APointKeepsItsComponents()
        {
            var point = new Vector3<Flu>(1, 2, 3);
            Assert.AreEqual(point, point.ToPointMsg().As<Flu>());
        }
    }
}
