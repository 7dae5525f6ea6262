// SPDX-License-Identifier: Apache-2.0
using System.Collections;
using System.Linq;
using System.Reflection;
using NUnit.Framework;
using Ros2Gateway.Messages;
using Ros2Gateway.Messages.Nav2Msgs;
using Ros2Gateway.Messages.Tf2Msgs;
using Ros2Gateway.Messages.VisionMsgs;
using Ros2Gateway.Unity;
using Ros2Gateway.Unity.Tests;
using UnityEngine;
using UnityEngine.TestTools;

namespace Ros2Gateway.OwnMessages.Tests
{
    /// <summary>Generated classes of packages that the Unity package has not, through a live gateway.</summary>
    [TestFixture]
    public sealed class OwnMessagesTests
    {
        private DisplayScene _scene;

        [SetUp]
        public void SetUp()
        {
            _scene = new DisplayScene();
            Load();
        }

        [TearDown]
        public void TearDown()
        {
            _scene.Dispose();
        }

        [Test]
        public void TheCatalogueMakesMessagesAndPartsAndListsMessages()
        {
            Assert.IsInstanceOf<SpeedLimitMsg>(MessageCatalogue.Create("nav2_msgs/SpeedLimit"));
            Assert.IsInstanceOf<NavigateToPoseGoal>(MessageCatalogue.Create("nav2_msgs/action/NavigateToPose_Goal"));
            Assert.IsInstanceOf<LoadMapResponse>(MessageCatalogue.Create("nav2_msgs/srv/LoadMap_Response"));
            CollectionAssert.Contains(MessageCatalogue.Types, "control_msgs/msg/JointJog");
            CollectionAssert.Contains(MessageCatalogue.Types, "std_msgs/msg/String");
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator ATopicSubscriberGetsTheClassOfWhatATopicPublisherSends()
        {
            _scene.Connect();
            TopicSubscriber subscriber = Subscriber("/speed_limit", "nav2_msgs/msg/SpeedLimit");
            _scene.Publisher("/speed_limit", "nav2_msgs/SpeedLimit", made =>
            {
                made.Message = "{\"percentage\":true,\"speed_limit\":0.1,\"header\":{\"frame_id\":\"map\"}}";
                made.Rate = 20;
            });
            yield return _scene.Until(() => subscriber.Last != null, "for a limit");
            SpeedLimitMsg limit = (SpeedLimitMsg)subscriber.Last;
            Assert.IsTrue(limit.percentage);
            Assert.AreEqual(0.1, limit.speed_limit);
            Assert.AreEqual("map", limit.header.frame_id);
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator ATypedMessageWithNestedOnesComesBackAsItWent()
        {
            GatewayClient client = _scene.Connect().Client;
            Detection2DArrayMsg heard = null;
            client.Subscribe<Detection2DArrayMsg>("/detections", message => heard = message);
            Publisher<Detection2DArrayMsg> publisher = client.Advertise<Detection2DArrayMsg>("/detections");
            Detection2DMsg one = new Detection2DMsg { id = "grün", results = new[] { new ObjectHypothesisWithPoseMsg() } };
            one.results[0].hypothesis.score = 1e-9;
            Detection2DArrayMsg sent = new Detection2DArrayMsg { detections = new[] { one, new Detection2DMsg() } };
            yield return _scene.Until(() => client.IsConnected, "for the connection");
            yield return _scene.Until(() => heard != null, "for detections", () => publisher.Publish(sent));
            Assert.AreEqual(2, heard.detections.Length);
            Assert.AreEqual("grün", heard.detections[0].id);
            Assert.AreEqual(1e-9, heard.detections[0].results[0].hypothesis.score);
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator TheRobotsTransformsAreOfTheGeneratedClass()
        {
            GatewayClient client = _scene.Connect().Client;
            TFMessageMsg heard = null;
            client.Subscribe<TFMessageMsg>("/tf", message => heard = message);
            yield return _scene.Until(() => heard != null && heard.transforms.Length > 0, "for transforms");
            Assert.IsNotEmpty(heard.transforms[0].child_frame_id);
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator AServiceOfAGeneratedTypeIsProvidedAndCalled()
        {
            GatewayClient client = _scene.Connect().Client;
            client.AdvertiseService<LoadMapRequest, LoadMapResponse>("/load_map", LoadMapRequest.Service, request =>
            {
                LoadMapResponse response = new LoadMapResponse { result = LoadMapResponse.RESULT_INVALID_MAP_DATA };
                response.map.header.frame_id = request.map_url;
                response.map.data = new sbyte[] { -1, 0, 100 };
                return response;
            });
            yield return _scene.Until(() => client.IsConnected, "for the connection");
            LoadMapResponse answer = null;
            bool isAsked = false;
            yield return _scene.Until(() => answer != null, "for the map", () =>
            {
                if (!isAsked)
                {
                    isAsked = true;
                    client.CallService<LoadMapResponse>(
                        "/load_map", new LoadMapRequest { map_url = "a.yaml" }, reply =>
                        {
                            isAsked = reply.Ok; // it may not be there yet
                            answer = reply.Ok ? reply.Value : null;
                        });
                }
            });
            Assert.AreEqual(LoadMapResponse.RESULT_INVALID_MAP_DATA, answer.result);
            Assert.AreEqual("a.yaml", answer.map.header.frame_id);
            CollectionAssert.AreEqual(new sbyte[] { -1, 0, 100 }, answer.map.data);
        }

        /// <summary>The start of Unity.</summary>
        private static void Load()
        {
            const BindingFlags Anything = BindingFlags.Static | BindingFlags.Public | BindingFlags.NonPublic;
            foreach (MethodInfo method in typeof(SpeedLimitMsg).Assembly.GetTypes().SelectMany(t => t.GetMethods(Anything)))
            {
                if (method.IsDefined(typeof(RuntimeInitializeOnLoadMethodAttribute), false))
                {
                    method.Invoke(null, null);
                }
            }
        }

        private TopicSubscriber Subscriber(string topic, string type)
        {
            TopicSubscriber subscriber = _scene.Inactive("subscriber").AddComponent<TopicSubscriber>();
            subscriber.Topic = topic;
            subscriber.Type = type;
            subscriber.gameObject.SetActive(true);
            return subscriber;
        }
    }
}
