// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections;
using System.Diagnostics;
using System.Linq;
using System.Net;
using System.Net.Sockets;
using System.Text;
using NUnit.Framework;
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Unity;
using UnityEditor;
using UnityEngine;
using UnityEngine.Stage;
using UnityEngine.TestTools;

namespace Ros2Gateway.Editor.Tests
{
    /// <summary>Someone clicks in the inspectors, with the live gateway behind them.</summary>
    [TestFixture]
    public sealed class InspectorClicksTests
    {
        private const int TimeoutMilliseconds = 120000; // a machine may be busy with other things

        private const string TwoAddresses = "{\"op\":\"gateway\",\"id\":\"4f1d\",\"name\":\"robot7\",\"path\":\"/\","
            + "\"port\":9090,\"tls\":false,\"tls_port\":9443,\"token\":true}";

        private GameObject _holder;
        private GatewaySettings _settings;
        private UnityEditor.Editor _editor;

        [SetUp]
        public void SetUp()
        {
            _settings = ScriptableObject.CreateInstance<GatewaySettings>();
            _holder = new GameObject("holder");
            _holder.SetActive(false);
        }

        [TearDown]
        public void TearDown()
        {
            if (_editor != null)
            {
                UnityEngine.Object.DestroyImmediate(_editor);
            }
            UnityEngine.Object.DestroyImmediate(_holder);
            UnityEngine.Object.DestroyImmediate(_settings);
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator A_topic_of_the_live_graph_is_chosen_with_its_type()
        {
            _settings.Address = Gateway();
            TopicSubscriber subscriber = Subscriber();
            Look("Connect");
            Look();
            StringAssert.StartsWith("connecting to ws://", Inspector.Words[0]);
            yield return Until(() => !Inspector.Words.Any(words => words.Contains("connect")));
            Look("Topics");
            string item = Inspector.Menu.Keys.Single(key => key.EndsWith("LaserScan"));
            StringAssert.DoesNotContain("/", item, "a slash makes a submenu");
            Inspector.Menu[item]();
            Assert.AreEqual("/scan", subscriber.Topic);
            Assert.AreEqual("sensor_msgs/msg/LaserScan", subscriber.Type);
            subscriber.Type = "1";
            Look();
            CollectionAssert.Contains(Inspector.Words, "/scan carries sensor_msgs/msg/LaserScan now");
        }

        [Test]
        public void A_type_is_found_by_its_number_and_chosen()
        {
            TopicSubscriber subscriber = Subscriber();
            Inspector.Write("Find a type", "6");
            Look("Types");
            Inspector.Menu.Single(item => item.Key.StartsWith("6  ")).Value();
            Assert.AreEqual("sensor_msgs/msg/BatteryState", subscriber.Type);
            Assert.AreEqual("/odom", subscriber.Topic);
            Inspector.Write("Find a type", "nonsense");
            Look("Types");
            Assert.IsNull(Inspector.Menu["no type is called nonsense"]);
            Inspector.Write("Find a type", "");
            Look("Types");
            Assert.IsTrue(Inspector.Menu.ContainsKey("geometry_msgs/Twist"));
        }

        [Test]
        public void What_is_wrong_is_said()
        {
            TopicSubscriber subscriber = Subscriber();
            subscriber.Topic = "/no good";
            subscriber.Type = "Twist";
            Look();
            Assert.AreEqual(2, Inspector.Words.Count, string.Join(" | ", Inspector.Words));
        }

        [Test]
        public void A_message_is_edited_as_text_or_field_by_field()
        {
            TopicPublisher publisher = Publisher();
            publisher.Type = "geometry_msgs/msg/Twist";
            publisher.Message = "{\"linear\":{\"x\":0.5}}";
            Look("Edit the fields");
            TwistMsg twist = (TwistMsg)publisher.Fields;
            Assert.AreEqual(0.5, twist.linear.x);
            twist.angular.z = 2;
            publisher.Type = "std_msgs/msg/String";
            Look();
            CollectionAssert.Contains(
                Inspector.Words, "the fields are those of geometry_msgs/msg/Twist, the type is std_msgs/msg/String");
            publisher.Type = "geometry_msgs/Twist";
            Look("Edit as text");
            Assert.IsNull(publisher.Fields);
            StringAssert.Contains("\"angular\":{\"x\":0.0,\"y\":0.0,\"z\":2.0}", publisher.Message);
            Look("Edit the fields");
            Look("Clear the fields");
            Assert.AreEqual(0, ((TwistMsg)publisher.Fields).angular.z);
            Assert.IsEmpty(Inspector.Words.Where(words => words.StartsWith("the fields")));
        }

        [Test]
        public void What_has_no_fields_says_why()
        {
            TopicPublisher publisher = Publisher();
            publisher.Message = "{\"data\":7}";
            Look("Edit the fields");
            StringAssert.StartsWith("the text is not a std_msgs/msg/String: ", Inspector.Words.Last());
            publisher.Type = "own_msgs/msg/Unknown";
            Look("Edit the fields");
            StringAssert.StartsWith("no class for own_msgs/msg/Unknown", Inspector.Words.Last());
            Assert.IsNull(publisher.Fields);
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator The_connection_is_tested_from_the_settings()
        {
            _settings.Address = Gateway();
            Open(_settings, typeof(GatewaySettingsInspector));
            Look("Test connection");
            yield return Until(() => Inspector.Words.Any(words => words.StartsWith("ros2-json-gateway")));
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator The_connection_is_tested_beside_its_own_address()
        {
            GatewayConnection connection = _holder.AddComponent<GatewayConnection>();
            connection.Address = Gateway();
            Open(connection, typeof(GatewayConnectionInspector));
            Look("Test connection");
            yield return Until(() => Inspector.Words.Any(words => words.StartsWith("ros2-json-gateway")));
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator A_gateway_of_this_network_is_found_and_chosen_for_the_settings()
        {
            return GatewayIsChosen(_settings, typeof(GatewaySettingsInspector), () => _settings.Address);
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator A_gateway_of_this_network_is_found_and_chosen_for_the_connection()
        {
            GatewayConnection connection = _holder.AddComponent<GatewayConnection>();
            connection.Settings = _settings;
            yield return GatewayIsChosen(
                connection, typeof(GatewayConnectionInspector), () => connection.Address);
            Assert.AreEqual("ws://localhost:9090", _settings.Address, "other scenes have it, too");
        }

        [UnityTest]
        public IEnumerator Of_a_gateway_with_two_addresses_the_encrypted_one_is_offered_first()
        {
            IPAddress here = IPAddress.Parse("127.0.0.9");
            using (Socket robot = new Socket(AddressFamily.InterNetwork, SocketType.Dgram, ProtocolType.Udp))
            {
                robot.SetSocketOption(SocketOptionLevel.Socket, SocketOptionName.ReuseAddress, true);
                robot.Bind(new IPEndPoint(here, GatewayFinder.Port));
                Open(_settings, typeof(GatewaySettingsInspector));
                ((AddressInspector)_editor).Targets = new[] { here };
                Look("Find gateways");
                yield return Until(() => robot.Available > 0);
                EndPoint sender = new IPEndPoint(IPAddress.Any, 0);
                robot.ReceiveFrom(new byte[1024], ref sender);
                robot.SendTo(Encoding.ASCII.GetBytes(TwoAddresses), sender);
                yield return Until(() => Inspector.Buttons.Any(text => text.StartsWith("robot7")));
                CollectionAssert.AreEqual(
                    new[]
                    {
                        "robot7  wss://127.0.0.9:9443/, needs a token", "robot7  ws://127.0.0.9:9090/, needs a token",
                    },
                    Inspector.Buttons.Where(text => text.StartsWith("robot7")));
                Look("robot7  ws://127.0.0.9:9090/, needs a token");
                Assert.AreEqual("ws://127.0.0.9:9090/", _settings.Address);
            }
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator A_closed_inspector_leaves_nothing_in_the_editors_update()
        {
            _settings.Address = Gateway();
            Subscriber();
            Look("Connect");
            Assert.IsNotNull(EditorApplication.update);
            UnityEngine.Object.DestroyImmediate(_editor);
            Assert.IsNull(EditorApplication.update);
            Open(_settings, typeof(GatewaySettingsInspector));
            Look("Test connection");
            Assert.IsNotNull(EditorApplication.update);
            yield return Until(() => EditorApplication.update == null);
        }

        private IEnumerator GatewayIsChosen(UnityEngine.Object of, Type inspector, Func<string> chosen)
        {
            int port = new Uri(Gateway()).Port;
            Open(of, inspector);
            ((AddressInspector)_editor).Targets = new[] { IPAddress.Parse("127.255.255.255") };
            Look("Find gateways");
            StringAssert.StartsWith("no gateway has answered yet", Inspector.Words[0]);
            string address = "ws://127.0.0.1:" + port + "/";
            yield return Until(() => Inspector.Buttons.Any(text => text.EndsWith("  " + address)));
            Inspector.Applied.Clear();
            Look(Inspector.Buttons.Single(text => text.EndsWith("  " + address)));
            Assert.AreEqual(address, chosen());
            Assert.AreEqual(1, Inspector.Applied.Count, "an instance of a prefab keeps it");
            Look();
            Assert.IsEmpty(Inspector.Words);
            Assert.IsNull(EditorApplication.update);
        }

        private static string Gateway()
        {
            string address = Environment.GetEnvironmentVariable("ROS2GATEWAY_TEST_URL");
            if (string.IsNullOrEmpty(address))
            {
                Assert.Ignore("needs a gateway: set ROS2GATEWAY_TEST_URL");
            }
            return address;
        }

        private TopicSubscriber Subscriber()
        {
            GatewayConnection connection = _holder.AddComponent<GatewayConnection>();
            connection.Settings = _settings;
            TopicSubscriber subscriber = _holder.AddComponent<TopicSubscriber>();
            subscriber.Connection = connection;
            Open(subscriber, typeof(TopicSubscriberInspector));
            return subscriber;
        }

        private TopicPublisher Publisher()
        {
            TopicPublisher publisher = _holder.AddComponent<TopicPublisher>();
            Open(publisher, typeof(TopicPublisherInspector));
            return publisher;
        }

        private void Open(UnityEngine.Object target, Type inspector)
        {
            _editor = UnityEditor.Editor.CreateEditor(target, inspector);
        }

        private void Look(string click = null)
        {
            Inspector.Look(_editor.OnInspectorGUI, click);
        }

        /// <summary>Goes on as the editor does: its update, and a look at the inspector.</summary>
        private IEnumerator Until(Func<bool> holds)
        {
            Stopwatch watch = Stopwatch.StartNew();
            while (!holds())
            {
                string shown = string.Join(" | ", Inspector.Words);
                Assert.Less(watch.ElapsedMilliseconds, TimeoutMilliseconds, shown);
                if (EditorApplication.update != null)
                {
                    EditorApplication.update();
                }
                Look();
                yield return null;
            }
        }
    }
}
