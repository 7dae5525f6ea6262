// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections;
using System.Diagnostics;
using System.Reflection;
using NUnit.Framework;
using Ros2Gateway.Unity;
using UnityEditor;
using UnityEngine;
using UnityEngine.TestTools;

namespace Ros2Gateway.Editor.Tests
{
    /// <summary>A new user follows the tutorial, with the packages and the script that it names.</summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class TutorialTests
    {
        private const int TimeoutMilliseconds = 120000; // a machine may be busy with other things

        [UnityTest]
        public IEnumerator Its_scene_shows_the_camera_and_the_place_and_moves_the_cube()
        {
            GameObject scene = new GameObject("scene");
            scene.SetActive(false); // until Play
            MenuCommand command = new MenuCommand(scene);
            GatewayMenu.Connection(command);
            Made<GatewayConnection>().Address = Environment.GetEnvironmentVariable("ROS2GATEWAY_TEST_URL");
            DisplaysMenu.ImageScreen(command);
            ImageScreen screen = Made<ImageScreen>();
            DisplaysMenu.TextScreen(command);
            TopicSubscriber place = Made<TopicSubscriber>();
            TextMesh text = Made<TextMesh>();
            place.Topic = "/odom";
            typeof(TopicSubscriber).GetField("_fields", BindingFlags.Instance | BindingFlags.NonPublic)
                .SetValue(place, new[] { "pose.pose.position" }); // by the Inspector alone
            DisplaysMenu.Teleop(command);
            GameObject cube = GameObject.CreatePrimitive(PrimitiveType.Cube);
            cube.transform.SetParent(scene.transform);
            cube.transform.position = new UnityEngine.Vector3(1000, 0, 0);
            cube.AddComponent<Odometer>();
            scene.SetActive(true);
            Stopwatch watch = Stopwatch.StartNew();
            while (screen.IsStale || !text.text.Contains("position") || cube.transform.position.x > 100)
            {
                Assert.Less(watch.ElapsedMilliseconds, TimeoutMilliseconds, text.text + " " + cube.transform.position.x);
                yield return null;
            }
            UnityEngine.Object.DestroyImmediate(scene);
        }

        private static T Made<T>()
            where T : Component => ((GameObject)Selection.activeObject).GetComponent<T>();
    }
}
