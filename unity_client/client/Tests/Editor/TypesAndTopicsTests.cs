// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;
using NUnit.Framework;

namespace Ros2Gateway.Editor.Tests
{
    /// <summary>The catalogue of types, and the checks of what is typed.</summary>
    [TestFixture]
    public sealed class TypesAndTopicsTests
    {
        private readonly TypeCatalogue _catalogue = new();

        [Test]
        public void TheThesisNumbersComeFirst()
        {
            IList<string> all = _catalogue.Find("");
            Assert.AreEqual("std_msgs/msg/String", all[0]);
            Assert.AreEqual("geometry_msgs/msg/Twist", all[1]);
            Assert.AreEqual("nav_msgs/msg/Odometry", all[9]);
            Assert.AreEqual("9  nav_msgs/msg/Odometry", _catalogue.Label(all[9]));
            Assert.Greater(_catalogue.Count, 10);
            CollectionAssert.AllItemsAreUnique(all);
        }

        [Test]
        public void ATypeIsFoundByPartOfItsNameOrItsNumber()
        {
            CollectionAssert.Contains(_catalogue.Find("laser"), "sensor_msgs/msg/LaserScan");
            CollectionAssert.DoesNotContain(_catalogue.Find("laser"), "std_msgs/msg/String");
            CollectionAssert.Contains(_catalogue.Find(" 7 "), "sensor_msgs/msg/LaserScan");
            CollectionAssert.IsEmpty(_catalogue.Find("no such thing"));
            CollectionAssert.AreEqual(_catalogue.Find(""), _catalogue.Find(null));
        }

        [Test]
        public void NoPartOfAServiceIsOfferedForATopic() => CollectionAssert.IsEmpty(_catalogue.Find("/srv/"));

        [TestCase("/odom")]
        [TestCase("odom")]
        [TestCase("/robot_1/camera/image_raw")]
        public void ATopicIsRight(string topic) => Assert.IsNull(TopicCheck.OfTopic(topic));

        [TestCase("")]
        [TestCase(null)]
        [TestCase("/")]
        [TestCase("/odom/")]
        [TestCase("/a//b")]
        [TestCase("/1robot")]
        [TestCase("/my topic")]
        [TestCase("/r\u00f6bot")]
        public void ATopicIsWrong(string topic) => Assert.IsNotNull(TopicCheck.OfTopic(topic));

        [Test]
        public void WhatIsWrongWithATypeIsSaidInWords()
        {
            Assert.IsNull(TopicCheck.OfType("", true));
            Assert.AreEqual("a publisher needs a type", TopicCheck.OfType("", false));
            Assert.IsNull(TopicCheck.OfType("geometry_msgs/msg/Twist", false));
            Assert.IsNull(TopicCheck.OfType("geometry_msgs/Twist", false));
            Assert.IsNull(TopicCheck.OfType("1", false));
            StringAssert.StartsWith("there is no message type with the number 9999", TopicCheck.OfType("9999", false));
            StringAssert.Contains("has no class here", TopicCheck.OfType("my_msgs/msg/Thing", false));
            StringAssert.Contains("is not a type", TopicCheck.OfType("Twist", false));
        }

        [Test]
        public void AnotherTypeThanTheTopicCarriesIsSaid()
        {
            Assert.AreEqual(
                "/odom carries nav_msgs/msg/Odometry now",
                TopicCheck.OfGraph("/odom", "1", "nav_msgs/msg/Odometry"));
            Assert.IsNull(TopicCheck.OfGraph("/odom", "9", "nav_msgs/msg/Odometry"));
            Assert.IsNull(TopicCheck.OfGraph("/odom", "", "nav_msgs/msg/Odometry"));
            Assert.IsNull(TopicCheck.OfGraph("/odom", "1", ""));
        }
    }
}
