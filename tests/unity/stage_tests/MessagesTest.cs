// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections;
using System.Collections.Generic;
using System.Threading;
using System.Threading.Tasks;
using NUnit.Framework;
using UnityEngine;
using UnityEngine.Stage;
using UnityEngine.TestTools;
using Object = UnityEngine.Object;

namespace Ros2Gateway.Stage.Tests
{
    public class Recorder : MonoBehaviour
    {
        public static readonly List<string> Calls = new List<string>();
        [SerializeField] private int _number = 3;

        public int Number
        {
            get { return _number; }
            set { _number = value; }
        }

        protected void Awake()
        {
            Calls.Add("Awake");
        }

        private void OnEnable()
        {
            Calls.Add("OnEnable");
        }

        private void Start()
        {
            Calls.Add("Start");
        }

        private void Update()
        {
            Calls.Add("Update");
            transform.position += Vector3.forward * Time.deltaTime;
        }

        private void LateUpdate()
        {
            Calls.Add("LateUpdate");
        }

        private void OnDisable()
        {
            Calls.Add("OnDisable");
        }

        private void OnDestroy()
        {
            Calls.Add("OnDestroy");
        }

        private void OnApplicationFocus(bool focused)
        {
            Calls.Add("focus " + focused);
        }
    }

    [DefaultExecutionOrder(-100)]
    public class Early : MonoBehaviour
    {
        private void Update()
        {
            Recorder.Calls.Add("early");
        }
    }

    public class Thrower : MonoBehaviour
    {
        private void Update()
        {
            throw new InvalidOperationException("on purpose");
        }
    }

    [TestFixture]
    public class MessagesTest
    {
        private GameObject _object;

        [SetUp]
        public void SetUp()
        {
            _object = new GameObject("robot");
            Recorder.Calls.Clear();
        }

        [TearDown]
        public void TearDown()
        {
            Object.DestroyImmediate(_object);
        }

        [Test]
        public void Messages_come_in_unitys_order()
        {
            _object.AddComponent<Recorder>();
            PlayerLoop.Step(0.5f);
            Object.Destroy(_object);
            PlayerLoop.Step(0.5f);
            CollectionAssert.AreEqual(
                new[] { "Awake", "OnEnable", "Start", "Update", "LateUpdate",
                    "Update", "LateUpdate", "OnDisable", "OnDestroy" },
                Recorder.Calls);
            Assert.IsTrue(_object == null);
        }

        [Test]
        public void An_inactive_object_gets_no_message_until_it_is_active()
        {
            _object.SetActive(false);
            _object.AddComponent<Recorder>();
            PlayerLoop.Step();
            CollectionAssert.IsEmpty(Recorder.Calls);
            _object.SetActive(true);
            CollectionAssert.AreEqual(new[] { "Awake", "OnEnable" }, Recorder.Calls);
        }

        [Test]
        public void A_disabled_component_gets_no_update()
        {
            var recorder = _object.AddComponent<Recorder>();
            PlayerLoop.Step();
            recorder.enabled = false;
            Recorder.Calls.Clear();
            PlayerLoop.Step();
            CollectionAssert.IsEmpty(Recorder.Calls);
        }

        [Test]
        public void Focus_reaches_every_component()
        {
            _object.AddComponent<Recorder>();
            PlayerLoop.SetFocus(false);
            PlayerLoop.SetFocus(true);
            CollectionAssert.IsSubsetOf(new[] { "focus False", "focus True" }, Recorder.Calls);
        }

        [Test]
        public void The_execution_order_decides_who_is_first()
        {
            _object.AddComponent<Recorder>();
            _object.AddComponent<Early>();
            PlayerLoop.Step();
            Assert.Less(Recorder.Calls.IndexOf("early"), Recorder.Calls.IndexOf("Update"));
        }

        [Test]
        public void An_exception_in_a_message_is_logged_and_goes_no_further()
        {
            _object.AddComponent<Thrower>();
            LogAssert.Expect(LogType.Exception, "InvalidOperationException: on purpose");
            PlayerLoop.Step();
        }

        [Test]
        public void A_command_that_a_busy_machine_held_up_fails_nothing()
        {
            Debug.LogError("publish: topic /cmd_vel: by its monotonic_ms the command came over 250 ms later");
        }

        [Test]
        public void Unity_refuses_calls_off_the_main_thread()
        {
            Exception problem = null;
            var thread = new Thread(() =>
            {
                try
                {
                    Debug.Log("allowed everywhere");
                    problem = new InvalidOperationException("allowed: " + _object.transform.position);
                }
                catch (UnityException exception)
                {
                    problem = exception;
                }
            });
            thread.Start();
            Assert.IsTrue(thread.Join(10000));
            StringAssert.Contains("can only be called from the main thread", problem.Message);
        }

        [Test]
        public void A_copy_refers_to_its_own_parts_and_keeps_serialized_fields()
        {
            var recorder = _object.AddComponent<Recorder>();
            recorder.Number = 7;
            new GameObject("wheel").transform.parent = _object.transform;
            Recorder copy = Object.Instantiate(recorder, new Vector3(1, 2, 3), Quaternion.identity);
            Assert.AreEqual("robot(Clone)", copy.name);
            Assert.AreEqual(7, copy.Number);
            Assert.AreEqual(1, copy.transform.childCount);
            Assert.AreNotSame(recorder.gameObject, copy.gameObject);
            Assert.AreEqual(new Vector3(1, 2, 3), copy.transform.position);
            Object.DestroyImmediate(copy.gameObject);
        }

        [UnityTest]
        public IEnumerator A_unity_test_runs_a_frame_for_every_null()
        {
            _object.AddComponent<Recorder>();
            int before = Time.frameCount;
            yield return null;
            yield return null;
            Assert.AreEqual(before + 2, Time.frameCount);
            Assert.Contains("LateUpdate", Recorder.Calls);
        }

        [UnityTest]
        public IEnumerator A_unity_test_waits_for_conditions_and_time()
        {
            double start = Time.timeAsDouble;
            yield return new WaitForSeconds(0.05f);
            Assert.GreaterOrEqual(Time.timeAsDouble, start + 0.049);
            Task<int> task = Task.Run(() => 5);
            yield return new WaitUntil(() => task.IsCompleted);
            Assert.AreEqual(5, task.Result);
        }

        [UnityTest]
        public IEnumerator What_is_awaited_goes_on_in_a_later_frame_on_the_main_thread()
        {
            int frame = Time.frameCount;
            Task<int> later = LaterFrame();
            while (!later.IsCompleted)
            {
                yield return null;
            }
            Assert.Greater(later.Result, frame);
        }

        private static async Task<int> LaterFrame()
        {
            await Task.Yield();
            return Time.frameCount;
        }

        [UnityTest]
        public IEnumerator Coroutines_go_on_frame_by_frame()
        {
            var recorder = _object.AddComponent<Recorder>();
            var counts = new List<int>();
            Coroutine counting = recorder.StartCoroutine(Count(counts));
            Assert.AreEqual(1, counts.Count);
            yield return counting;
            CollectionAssert.AreEqual(new[] { 0, 1, 2 }, counts);
        }

        private static IEnumerator Count(List<int> counts)
        {
            for (int i = 0; i < 3; i++)
            {
                counts.Add(i);
                yield return null;
            }
        }
    }
}
