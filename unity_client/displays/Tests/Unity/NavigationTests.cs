// SPDX-License-Identifier: Apache-2.0
using System.Collections;
using System.Collections.Generic;
using NUnit.Framework;
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Messages.StdSrvs;
using UnityEngine;
using UnityEngine.TestTools;

namespace Ros2Gateway.Unity.Tests
{
    /// <summary>Goals of the scene for the simulated robot, which has Nav2's action.</summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class NavigationTests
    {
        private const string StartedAnew = "/reset";

        private DisplayScene _scene;
        private FixedFrame _map;

        [SetUp]
        public void SetUp()
        {
            _scene = new DisplayScene();
            _scene.Connect();
            _map = _scene.Fixed("map");
            _map.transform.position = new Vector3(10, 0, 0); // the map need not be at the scene's origin
        }

        [TearDown]
        public void TearDown() => _scene.Dispose();

        [UnityTest]
        public IEnumerator AGoalIsPursuedCalledOffAndReplaced()
        {
            NavigateToPose navigation = Navigation();
            List<string> heard = new();
            navigation.StatusChanged += heard.Add;
            int ended = 0;
            navigation.OnEnded.AddListener(() => ended++);
            yield return Reset();
            yield return Pursued(navigation, Place(new Vector3(0, 0, 1)));
            StringAssert.EndsWith(" m to go", navigation.Status);
            Assert.Greater(navigation.Feedback.distance_remaining, 0.5f);
            Assert.AreEqual("map", navigation.Feedback.current_pose.header.frame_id);
            navigation.Send(Place(new Vector3(0, 0, 1)).transform);
            yield return _scene.Until(() => navigation.Feedback != null, "for feedback of the second");
            Assert.AreEqual(0, ended, "the end of the replaced one is no news");
            navigation.Cancel();
            Assert.AreEqual("cancelling", navigation.Status);
            yield return _scene.Until(() => !navigation.IsActive, "for the end");
            Assert.AreEqual(GoalStatus.Canceled, navigation.GoalStatus);
            Assert.AreEqual("cancelled", navigation.Status);
            Assert.AreEqual(1, ended);
            CollectionAssert.Contains(heard, "in progress");
        }

        [UnityTest]
        public IEnumerator AGoalIsReached()
        {
            NavigateToPose navigation = Navigation();
            int reached = 0;
            navigation.OnReached.AddListener(() => reached++);
            yield return Reset();
            GameObject place = Place(new Vector3(0, 0.7f, 0.3f)); // in the air: a robot drives below it
            place.transform.rotation = Quaternion.Euler(10, 0, 0);
            yield return Pursued(navigation, place);
            yield return _scene.Until(() => !navigation.IsActive, "to be there");
            Assert.AreEqual("reached", navigation.Status);
            Assert.AreEqual(1, reached);
        }

        [UnityTest]
        public IEnumerator DisablingItCancelsTheGoal()
        {
            NavigateToPose navigation = Navigation();
            yield return Reset();
            yield return Pursued(navigation, Place(new Vector3(0, 0, 1)));
            navigation.enabled = false;
            yield return _scene.Until(() => navigation.GoalStatus == GoalStatus.Canceled, "for the cancellation");
            navigation.Send(Place(Vector3.zero).transform);
            StringAssert.Contains("disabled", navigation.Status);
        }

        [UnityTest]
        public IEnumerator AnActionThatNobodyHasIsToldInWords()
        {
            LogAssert.ignoreFailingMessages = true; // and in the console
            NavigateToPose navigation = Navigation();
            navigation.Action = "/navigate_nowhere";
            yield return _scene.Until(() => _scene.Connection.Client.IsConnected, "to be connected");
            navigation.Send();
            yield return _scene.Until(() => !navigation.IsActive, "for the refusal");
            StringAssert.Contains("/navigate_nowhere", navigation.Status);
        }

        [UnityTest]
        public IEnumerator AListenerThatThrowsHarmsNoOtherAndNotWhoSends()
        {
            LogAssert.ignoreFailingMessages = true; // that it is told is the point
            NavigateToPose navigation = Navigation();
            List<string> heard = new();
            navigation.StatusChanged += status => { throw new System.InvalidOperationException("by code"); };
            navigation.StatusChanged += heard.Add;
            int ended = 0;
            navigation.OnEnded.AddListener(() => ended++);
            navigation.OnEnded.AddListener(() => { throw new System.InvalidOperationException("by list"); });
            navigation.Action = "/navigate_nowhere";
            yield return _scene.Until(() => _scene.Connection.Client.IsConnected, "to be connected");
            navigation.Send();
            Assert.AreEqual("in progress", string.Join(" ", heard));
            yield return _scene.Until(() => ended == 1, "for the refusal");
            Assert.AreEqual(2, heard.Count);
            yield return _scene.Until(() => _scene.HasLogged(
                "listener of On Reached or On Ended of NavigateToPose on navigation threw InvalidOperationException: by list"), "for words");
            Assert.AreEqual(1, _scene.Logged.FindAll(text => text.Contains("listener of StatusChanged")).Count);
            navigation.enabled = false;
            Assert.DoesNotThrow(navigation.Send);
            StringAssert.Contains("disabled", heard[2]);
        }

        [UnityTest]
        public IEnumerator WhereANewGoalIsRefusedTheFormerIsPursuedAndCanBeCalledOff(
            [Values("cancel", "disable")] string how)
        {
            NavigateToPose navigation = Navigation();
            List<string> heard = new();
            navigation.StatusChanged += heard.Add;
            yield return Reset();
            GameObject place = Place(new Vector3(0, 0, 1));
            yield return Pursued(navigation, place);
            navigation.Action = "/navigate_nowhere";
            navigation.Send(place.transform);
            yield return _scene.Until(() => heard.Exists(text => text.Contains("/navigate_nowhere")), "for the refusal");
            Assert.IsTrue(navigation.IsActive);
            yield return _scene.Until(() => navigation.Feedback != null, "for feedback of the former");
            if (how == "cancel")
            {
                navigation.Cancel();
            }
            else
            {
                navigation.enabled = false;
            }
            Assert.AreEqual("cancelling", navigation.Status);
            yield return _scene.Until(() => !navigation.IsActive, "for the end");
            Assert.AreEqual(GoalStatus.Canceled, navigation.GoalStatus);
            Assert.AreEqual("cancelled", navigation.Status);
        }

        [UnityTest]
        public IEnumerator AGoalPoseIsPublishedInTheFixedFrameUpright()
        {
            PoseStampedMsg heard = null;
            _scene.Connection.Client.Subscribe<PoseStampedMsg>("/scene_goal", pose => heard = pose);
            GameObject holder = Below("goal", new Vector3(-2, 1, 3));
            holder.transform.rotation = Quaternion.Euler(20, -90, 0);
            GoalPosePublisher publisher = holder.AddComponent<GoalPosePublisher>();
            publisher.Topic = "/scene_goal";
            holder.SetActive(true);
            yield return _scene.Until(() => _scene.Connection.Client.IsConnected, "to be connected");
            yield return _scene.Until(() => heard != null, "for the goal", publisher.Publish);
            Assert.AreEqual("map", heard.header.frame_id);
            Assert.AreEqual(3, heard.pose.position.x, 1e-4);
            Assert.AreEqual(2, heard.pose.position.y, 1e-4);
            Assert.AreEqual(0, heard.pose.position.z);
            Assert.AreEqual(Mathf.Sqrt(0.5f), heard.pose.orientation.z, 1e-4, "to the left");
            Assert.AreEqual(0, heard.pose.orientation.x);
        }

        [UnityTest]
        public IEnumerator AGoalPoseThatCannotBePublishedIsAWarning()
        {
            GoalPosePublisher publisher = Below("goal", Vector3.zero).AddComponent<GoalPosePublisher>();
            publisher.Publish();
            Assert.IsTrue(_scene.HasLogged("Goal Pose Publisher on goal: no goal is sent: this component is disabled"));
            Object.DestroyImmediate(_scene.Connection.gameObject);
            publisher.gameObject.SetActive(true);
            publisher.Publish();
            Assert.IsTrue(_scene.HasLogged("Goal Pose Publisher on goal: no goal is sent: no Gateway Connection"));
            yield return null;
        }

        [UnityTest]
        public IEnumerator WithoutAFixedFrameTheScenesOriginCounts()
        {
            PoseStampedMsg heard = null;
            _scene.Connection.Client.Subscribe<PoseStampedMsg>("/scene_goal", pose => heard = pose);
            GameObject holder = _scene.Inactive("goal");
            holder.transform.position = new Vector3(0, 0, 2);
            GoalPosePublisher publisher = holder.AddComponent<GoalPosePublisher>();
            publisher.Topic = "/scene_goal";
            publisher.Frame = "odom";
            holder.SetActive(true);
            yield return _scene.Until(() => _scene.Connection.Client.IsConnected, "to be connected");
            yield return _scene.Until(() => heard != null, "for the goal", publisher.Publish);
            Assert.AreEqual("odom", heard.header.frame_id);
            Assert.AreEqual(2, heard.pose.position.x, 1e-4);
        }

        private NavigateToPose Navigation()
        {
            GameObject holder = Below("navigation", Vector3.zero);
            NavigateToPose made = holder.AddComponent<NavigateToPose>();
            holder.SetActive(true);
            return made;
        }

        private GameObject Place(Vector3 at) => Below("place", at);

        private GameObject Below(string name, Vector3 at)
        {
            GameObject made = _scene.Inactive(name);
            made.transform.SetParent(_map.transform, false);
            made.transform.localPosition = at;
            return made;
        }

        private IEnumerator Reset()
        {
            bool isReset = false;
            yield return _scene.Until(() => _scene.Connection.Client.IsConnected, "to be connected");
            _scene.Connection.Client.CallService<TriggerResponse>(
                StartedAnew, new TriggerRequest(), reply => isReset = reply.Ok);
            yield return _scene.Until(() => isReset, "for the robot to be at its start");
        }

        // The gateway may just have started, and not know the action yet.
        private IEnumerator Pursued(NavigateToPose navigation, GameObject place)
        {
            LogAssert.ignoreFailingMessages = true;
            return _scene.Until(() => navigation.Feedback != null, "for feedback", () =>
            {
                if (!navigation.IsActive && navigation.Feedback == null)
                {
                    navigation.Send(place.transform);
                }
            });
        }
    }
}
