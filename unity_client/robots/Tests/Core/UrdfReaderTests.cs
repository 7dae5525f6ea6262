// SPDX-License-Identifier: Apache-2.0
using System;
using System.Text;
using NUnit.Framework;
using Ros2Gateway.Robots;

namespace Ros2Gateway.Tests
{
    [TestFixture]
    public sealed class UrdfReaderTests
    {
        private const double Tolerance = 1e-9;

        private const string Arm = @"<?xml version='1.0'?>
<robot name='arm'>
  <material name='red'><color rgba='1 0 0 0.5'/></material>
  <link name='base'>
    <visual><geometry><box size='1 2 3'/></geometry><material name='red'/></visual>
    <visual>
      <origin xyz='0 0 1' rpy='0 0 1.5707963267948966'/>
      <geometry><cylinder radius='0.5' length='4'/></geometry>
      <material name='blue'><color rgba='0 0 1 1'/></material>
    </visual>
    <collision><geometry><box size='9 9 9'/></geometry></collision>
  </link>
  <!-- joints may stand before what they hang from -->
  <joint name='slide' type='prismatic'>
    <parent link='upper'/><child link='tool'/><axis xyz='0 3 0'/><origin xyz='0 0 2'/>
  </joint>
  <joint name='elbow' type='revolute'>
    <parent link='base'/><child link='upper'/><axis xyz='0 0 2'/><origin xyz='1 0 0'/>
  </joint>
  <joint name='follow' type='continuous'>
    <parent link='base'/><child link='other'/><mimic joint='elbow' multiplier='-2' offset='0.1'/>
  </joint>
  <link name='upper'>
    <visual><geometry><mesh filename='package://arm/meshes/upper.stl' scale='0.001 0.001 0.001'/></geometry></visual>
  </link>
  <link name='tool'><visual><geometry><sphere radius='0.1'/></geometry><material name='blue'/></visual></link>
  <link name='other'/>
  <gazebo reference='base'><anything/></gazebo>
</robot>";

        [Test]
        public void LinksHaveTheirShapesWhereTheyAre()
        {
            RobotDescription robot = UrdfReader.Read(Arm);
            Assert.AreEqual("arm", robot.Name);
            Assert.AreEqual("base", robot.Root);
            Assert.AreEqual(4, robot.Links.Count);
            Assert.AreEqual(2, robot.Links[0].Visuals.Count);
            RobotVisual box = robot.Links[0].Visuals[0], cylinder = robot.Links[0].Visuals[1];
            Assert.AreEqual(RobotShape.Box, box.Shape);
            Assert.AreEqual(new Vector3<Flu>(1, 2, 3), box.Size);
            Assert.AreEqual("#ff000080", box.Color.ToString());
            Assert.AreEqual(new Vector3<Flu>(1, 1, 4), cylinder.Size);
            Assert.AreEqual(1, cylinder.Origin.position.z, Tolerance);
            Assert.AreEqual(1, (cylinder.Origin.orientation * new Vector3<Flu>(1, 0, 0)).y, Tolerance);
            RobotVisual mesh = robot.Links[1].Visuals[0];
            Assert.AreEqual("package://arm/meshes/upper.stl", mesh.Mesh);
            Assert.AreEqual(0.001, mesh.Size.x);
            Assert.AreEqual("#0000ffff", robot.Links[2].Visuals[0].Color.ToString(), "named by another link");
        }

        [Test]
        public void JointsComeFromTheRootOnAndMove()
        {
            RobotDescription robot = UrdfReader.Read(Arm);
            Assert.AreEqual("elbow", robot.Joints[0].Name);
            Assert.AreEqual("slide", robot.Joints[2].Name);
            Pose<Flu> turned = robot.Joint("elbow").PoseAt(Math.PI / 2);
            Vector3<Flu> at = turned * new Vector3<Flu>(1, 0, 0);
            Assert.AreEqual(1, at.x, Tolerance);
            Assert.AreEqual(1, at.y, Tolerance);
            Vector3<Flu> slid = robot.Joint("slide").PoseAt(0.3).position;
            Assert.AreEqual(0.3, slid.y, Tolerance, "the axis counts as one of length 1");
            Assert.AreEqual(2, slid.z, Tolerance);
            RobotJoint follow = robot.Joint("follow");
            Assert.AreEqual("elbow", follow.Mimicked);
            Assert.AreEqual(-2, follow.Multiplier);
            Assert.AreEqual(0.1, follow.Offset);
            Assert.AreEqual(robot.Joint("elbow").PoseAt(0), robot.Joint("elbow").PoseAt(double.NaN));
            Assert.IsNull(robot.Joint("nobody"));
            Assert.IsNull(robot.Joint(null));
        }

        [Test]
        public void RollIsFirstAndYawIsLast()
        {
            string text = Robot("<link name='a'><visual><origin rpy='1.5707963267948966 0 1.5707963267948966'/>"
                + "<geometry><sphere radius='1'/></geometry></visual></link>");
            Quaternion<Flu> turn = UrdfReader.Read(text).Links[0].Visuals[0].Origin.orientation;
            Vector3<Flu> y = turn * new Vector3<Flu>(0, 1, 0); // up by the roll, where the yaw leaves it
            Assert.AreEqual(1, y.z, Tolerance);
            Vector3<Flu> x = turn * new Vector3<Flu>(1, 0, 0);
            Assert.AreEqual(1, x.y, Tolerance);
        }

        [TestCase("", "empty")]
        [TestCase("hello", "not XML")]
        [TestCase("<robot><link name='a'></robot>", "not XML")]
        [TestCase("<sdf/>", "begins with <sdf>")]
        [TestCase("<robot/>", "no links")]
        [TestCase("<!DOCTYPE r [<!ENTITY a 'b'>]><robot>&a;</robot>", "not XML")]
        [TestCase("<robot><link/></robot>", "a link has no name")]
        [TestCase("<robot><link name='a'/><link name='a'/></robot>", "two links a")]
        [TestCase("<robot><link name='a'/><link name='b'/></robot>", "one root")]
        [TestCase("<robot><link name='a'><visual/></link></robot>", "no geometry")]
        [TestCase("<robot><link name='a'><visual><geometry><cone/></geometry></visual></link></robot>", "neither box")]
        [TestCase("<robot><link name='a'><visual><geometry><box size='1 2'/></geometry></visual></link></robot>",
            "link a: box size is '1 2', must be 3 numbers")]
        [TestCase("<robot><link name='a'><visual><geometry><sphere radius='NaN'/></geometry></visual></link></robot>",
            "must be a number")]
        [TestCase("<robot><link name='a'/><joint name='j' type='fixed'><parent link='a'/></joint></robot>",
            "joint j: its child is missing")]
        [TestCase("<robot><link name='a'/><joint name='j' type='fixed'><parent link='x'/><child link='a'/></joint></robot>",
            "joint j: its parent x is not a link")]
        [TestCase("<robot><link name='a'/><link name='b'/><joint name='j' type='ball'><parent link='a'/><child link='b'/>"
            + "</joint></robot>", "the type ball is unknown")]
        [TestCase("<robot><link name='a'/><joint name='j' type='fixed'><parent link='a'/><child link='a'/></joint></robot>",
            "joints in a circle")]
        [TestCase("<robot><link name='r'/><link name='a'/><link name='b'/>"
            + "<joint name='j' type='fixed'><parent link='a'/><child link='b'/></joint>"
            + "<joint name='k' type='fixed'><parent link='b'/><child link='a'/></joint></robot>", "joint j is in a circle")]
        [TestCase("<robot><link name='r'/><link name='a'/>"
            + "<joint name='j' type='fixed'><parent link='r'/><child link='a'/></joint>"
            + "<joint name='k' type='fixed'><parent link='r'/><child link='a'/></joint></robot>", "hangs from two joints: j and k")]
        public void WhatIsNoDescriptionIsSaid(string text, string words)
        {
            UrdfException error = Assert.Throws<UrdfException>(() => UrdfReader.Read(text));
            StringAssert.Contains(words, error.Message);
        }

        [Test]
        public void WhatHasNoEndIsRefused()
        {
            StringBuilder links = new();
            for (int i = 0; i < 1001; i++)
            {
                links.Append("<link name='l" + i + "'/>");
            }
            StringAssert.Contains("more than 1000 links", Words(Robot(links.ToString())));
            StringAssert.Contains("at most 4194304", Words(new string(' ', 5000000)));
            StringBuilder visuals = new("<link name='a'>");
            for (int i = 0; i < 5001; i++)
            {
                visuals.Append("<visual><geometry><sphere radius='1'/></geometry></visual>");
            }
            StringAssert.Contains("more than 5000 visuals", Words(Robot(visuals + "</link>")));
            StringBuilder deep = new();
            for (int i = 0; i < 100000; i++)
            {
                deep.Append("<a>");
            }
            StringAssert.Contains("not XML", Words(deep.ToString()));
        }

        [Test]
        public void DamageIsWordsNeverAnotherException()
        {
            Random random = new(3);
            int refused = 0;
            for (int i = 0; i < 2000; i++)
            {
                char[] damaged = Arm.ToCharArray();
                for (int count = random.Next(1, 6); count > 0; count--)
                {
                    damaged[random.Next(damaged.Length)] = damaged[random.Next(damaged.Length)];
                }
                try
                {
                    UrdfReader.Read(new string(damaged));
                }
                catch (UrdfException)
                {
                    refused++;
                }
            }
            Assert.Greater(refused, 1000);
        }

        private static string Words(string text) => Assert.Throws<UrdfException>(() => UrdfReader.Read(text)).Message;

        private static string Robot(string content) => "<robot name='r'>" + content + "</robot>";
    }
}
