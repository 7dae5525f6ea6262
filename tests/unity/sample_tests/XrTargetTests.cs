// SPDX-License-Identifier: Apache-2.0
using System.Collections;
using NUnit.Framework;
using Ros2Gateway.Drive;
using Ros2Gateway.Samples.XrTarget;
using Ros2Gateway.Unity;
using UnityEngine;
using UnityEngine.InputSystem;
using UnityEngine.Stage;
using UnityEngine.TestTools;
using UnityEngine.XR;
using UnityEngine.XR.Interaction.Toolkit.Interactors;

namespace Ros2Gateway.Samples.Tests
{
    [TestFixture]
    public sealed class XrTargetTests
    {
        private sealed class Pointing : IPointerInput
        {
            public bool IsUserPresent { get; set; }

            public Ray Pointer { get; set; }

            public bool TargetPressed { get; set; }

            public bool TeleportPressed { get; set; }

            public bool StopPressed { get; set; }

            public void Poll()
            {
            }

            /// <summary>Straight down at a place of the floor.</summary>
            internal void At(float x, float z)
            {
                Pointer = new Ray(new Vector3(x, 2, z), Vector3.down);
            }
        }

        private DemoScene _demo;
        private Pointing _pointing;
        private XrTargetControl _control;
        private TargetDriver _driver;
        private GatewayClient _client;
        private Transform _twin;

        [TearDown]
        public void TearDown()
        {
            XrDevices.Disconnect();
            InputSystemDevices.Disconnect();
            if (_demo != null)
            {
                _demo.Dispose();
                _demo = null;
            }
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator The_robot_drives_to_where_the_trigger_points_and_the_grip_stops_it()
        {
            yield return Begin();
            bool isReached = false;
            _driver.Reached += () => isReached = true;
            _pointing.At(-0.3f, 0.2f);
            yield return Press(() => _pointing.TargetPressed = true);
            Assert.IsTrue(GameObject.Find("Target").activeSelf);
            yield return UntilDriven(() => isReached, "for the target");
            yield return _demo.Until(
                () => Vector3.Distance(_twin.position, new Vector3(-0.3f, 0, 0.2f)) < 0.05f, "for the twin");

            _pointing.At(0.3f, 0);
            yield return Press(() => _pointing.TargetPressed = true);
            yield return UntilDriven(() => _driver.State == DriveState.Turning, "for a turn");
            yield return Press(() => _pointing.StopPressed = true);
            Assert.AreEqual("the grip was pressed", _driver.Reason);
            Assert.AreEqual(DriveState.Idle, _driver.State);
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator A_headset_that_is_taken_off_stops_the_robot()
        {
            yield return Begin();
            _pointing.At(-0.3f, 0);
            yield return Press(() => _pointing.TargetPressed = true);
            yield return UntilDriven(() => _driver.State == DriveState.Turning, "for a turn");
            _pointing.IsUserPresent = false;
            yield return null;
            Assert.AreEqual("the headset was taken off", _driver.Reason);
            yield return Press(() => _pointing.TargetPressed = true);
            Assert.AreEqual(DriveState.Idle, _driver.State, "nobody is there");
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator The_feet_go_where_the_touchpad_points_but_never_onto_a_wall()
        {
            yield return Begin();
            Transform head = Camera.main.transform;
            head.localPosition = new Vector3(0.4f, 1.7f, 0.2f); // somewhere in the tracking space
            _pointing.At(1, 1);
            yield return Press(() => _pointing.TeleportPressed = true);
            AreClose(new Vector3(1, 1.7f, 1), head.position);
            GameObject wall = GameObject.CreatePrimitive(PrimitiveType.Cube);
            wall.transform.position = new Vector3(3, 1, 0);
            _pointing.Pointer = new Ray(new Vector3(0, 1, 0), Vector3.right);
            yield return Press(() => _pointing.TeleportPressed = true);
            AreClose(new Vector3(1, 1.7f, 1), head.position);
            Object.DestroyImmediate(wall);
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator A_headset_and_its_controllers_are_taken_as_soon_as_they_are_there()
        {
            yield return Begin();
            _control.Input = null; // the scene chooses one by itself
            yield return null;
            XrDevices.Set(XRNode.Head, CommonUsages.centerEyePosition, new Vector3(0.1f, 1.7f, 0));
            XrDevices.Set(XRNode.Head, CommonUsages.centerEyeRotation, Quaternion.Euler(0, 20, 0));
            XrDevices.Set(XRNode.RightHand, CommonUsages.devicePosition, new Vector3(-0.3f, 1, 0));
            XrDevices.Set(XRNode.RightHand, CommonUsages.deviceRotation, Quaternion.Euler(90, 0, 0));
            yield return null;
            XrDevices.Set(XRNode.RightHand, CommonUsages.triggerButton, true);
            yield return null;
            AreClose(new Vector3(0.1f, 1.7f, 0), Camera.main.transform.localPosition);
            Vector3 marker = GameObject.Find("Target").transform.position;
            AreClose(_control.Rig.TransformPoint(new Vector3(-0.3f, 0, 0)), marker);
            XrDevices.Set(XRNode.RightHand, CommonUsages.gripButton, true);
            yield return null;
            Assert.AreEqual("the grip was pressed", _driver.Reason);
        }

        [Test]
        public void Controllers_press_once_however_long_they_are_held()
        {
            XrDevices.Set(XRNode.Head, CommonUsages.userPresence, true);
            ControllerInput controllers = new ControllerInput(null);
            XrDevices.Set(XRNode.LeftHand, CommonUsages.triggerButton, true);
            controllers.Poll();
            Assert.IsFalse(controllers.TargetPressed, "it was down when the controller woke");
            XrDevices.Set(XRNode.LeftHand, CommonUsages.triggerButton, false);
            controllers.Poll();
            XrDevices.Set(XRNode.LeftHand, CommonUsages.triggerButton, true);
            controllers.Poll();
            Assert.IsTrue(controllers.TargetPressed);
            controllers.Poll();
            Assert.IsFalse(controllers.TargetPressed);
            XrDevices.Set(XRNode.LeftHand, CommonUsages.triggerButton, false);
            controllers.Poll();
            XrDevices.Set(XRNode.RightHand, CommonUsages.gripButton, true);
            controllers.Poll();
            Assert.IsFalse(controllers.TargetPressed);
            Assert.IsTrue(controllers.StopPressed);
        }

        [Test]
        public void A_stick_teleports_when_it_is_pushed_and_a_touchpad_when_it_is_clicked()
        {
            ControllerInput controllers = new ControllerInput(null);
            XrDevices.Set(XRNode.RightHand, CommonUsages.primary2DAxis, Vector2.zero);
            controllers.Poll();
            XrDevices.Set(XRNode.RightHand, CommonUsages.primary2DAxis, new Vector2(0, 0.9f));
            controllers.Poll();
            Assert.IsTrue(controllers.TeleportPressed);
            XrDevices.Set(XRNode.RightHand, CommonUsages.primary2DAxis, new Vector2(0, 0.5f));
            controllers.Poll();
            XrDevices.Set(XRNode.RightHand, CommonUsages.primary2DAxis, new Vector2(0, 0.9f));
            controllers.Poll();
            Assert.IsFalse(controllers.TeleportPressed, "the thumb only trembled");
            XrDevices.Name(XRNode.RightHand, "HTC Vive Controller OpenXR");
            controllers.Poll();
            controllers.Poll();
            Assert.IsFalse(controllers.TeleportPressed, "the thumb only rests");
            XrDevices.Set(XRNode.RightHand, CommonUsages.primary2DAxisClick, true);
            controllers.Poll();
            Assert.IsTrue(controllers.TeleportPressed);
        }

        [Test]
        public void The_hand_that_pressed_last_points_from_where_the_tracking_space_is()
        {
            GameObject space = new GameObject("space");
            space.transform.position = new Vector3(0, 0, 5);
            space.transform.rotation = Quaternion.Euler(0, 90, 0);
            ControllerInput controllers = new ControllerInput(space.transform);
            XrDevices.Set(XRNode.RightHand, CommonUsages.devicePosition, new Vector3(0, 1, 0));
            XrDevices.Set(XRNode.LeftHand, CommonUsages.devicePosition, new Vector3(0, 2, 1));
            XrDevices.Set(XRNode.LeftHand, CommonUsages.deviceRotation, Quaternion.Euler(90, 0, 0));
            controllers.Poll();
            AreClose(new Vector3(0, 1, 5), controllers.Pointer.origin);
            AreClose(Vector3.right, controllers.Pointer.direction);
            XrDevices.Set(XRNode.LeftHand, CommonUsages.gripButton, true);
            controllers.Poll();
            AreClose(new Vector3(1, 2, 5), controllers.Pointer.origin);
            AreClose(Vector3.down, controllers.Pointer.direction);
            Object.DestroyImmediate(space);
        }

        [Test]
        public void A_headset_without_a_sensor_is_worn_and_one_that_is_gone_is_not()
        {
            ControllerOrMouseInput input = new ControllerOrMouseInput(null, null);
            input.Poll();
            Assert.IsTrue(input.IsUserPresent, "somebody has the mouse");
            XrDevices.Set(XRNode.Head, CommonUsages.devicePosition, Vector3.zero);
            input.Poll();
            Assert.IsTrue(input.IsUserPresent);
            XrDevices.Set(XRNode.Head, CommonUsages.userPresence, false);
            input.Poll();
            Assert.IsFalse(input.IsUserPresent);
            XrDevices.Disconnect();
            input.Poll();
            Assert.IsFalse(input.IsUserPresent);
        }

        [UnityTest]
        public IEnumerator Actions_of_the_Input_System_and_a_ray_of_the_toolkit_do_the_same()
        {
            GameObject hand = new GameObject("hand");
            hand.SetActive(false);
            InputAction trigger = new InputAction("mine", InputActionType.Button);
            XrActionInput input = hand.AddComponent<XrActionInput>();
            input.Target = InputSystemDevices.Reference(trigger);
            input.RayInteractor = hand.AddComponent<XRRayInteractor>();
            hand.transform.position = new Vector3(1, 2, 3);
            hand.transform.rotation = Quaternion.Euler(90, 0, 0);
            hand.SetActive(true);
            InputSystemDevices.Set(trigger, 1f, true);
            PlayerLoop.Step();
            Assert.IsTrue(input.TargetPressed);
            Assert.IsFalse(input.StopPressed);
            Assert.IsFalse(input.TeleportPressed);
            AreClose(new Vector3(1, 2, 3), input.Pointer.origin);
            AreClose(Vector3.down, input.Pointer.direction);
            PlayerLoop.Step();
            Assert.IsFalse(input.TargetPressed);
            input.enabled = false;
            Assert.IsTrue(trigger.enabled, "it may be somebody else's, too");
            Object.DestroyImmediate(hand);
            yield break;
        }

        [Test]
        public void The_mouse_does_it_without_a_headset()
        {
            GameObject eyes = new GameObject("eyes", typeof(Camera));
            eyes.transform.position = new Vector3(0, 2, 0);
            InputSystemDevices.Connect();
            InputSystemDevices.Move(Mouse.current, new Vector2(Screen.width / 2, Screen.height / 2));
            MouseInput input = new MouseInput(eyes.GetComponent<Camera>());
            InputSystemDevices.Press(Mouse.current.leftButton);
            PlayerLoop.Step();
            input.Poll();
            Assert.IsTrue(input.TargetPressed);
            Assert.IsFalse(input.TeleportPressed);
            AreClose(Vector3.forward, input.Pointer.direction);
            InputSystemDevices.Press(UnityEngine.InputSystem.Keyboard.current.spaceKey);
            PlayerLoop.Step();
            input.Poll();
            Assert.IsFalse(input.TargetPressed);
            Assert.IsTrue(input.StopPressed);
            Object.DestroyImmediate(eyes);
        }

        private static void AreClose(Vector3 expected, Vector3 actual)
        {
            Assert.Less(Vector3.Distance(expected, actual), 1e-4f, expected + " expected, got " + actual);
        }

        private IEnumerator Begin()
        {
            _demo = new DemoScene();
            _demo.Add<XrTargetScene>().Address = DemoScene.Address;
            _demo.Begin();
            _pointing = new Pointing { IsUserPresent = true };
            _pointing.At(0, 0);
            _control = _demo.Root.GetComponentInChildren<XrTargetControl>();
            _control.Input = _pointing;
            _driver = _control.Driver;
            _twin = GameObject.Find("Digital Twin").transform;
            _client = GameObject.Find("Gateway Connection").GetComponent<GatewayConnection>().Client;
            yield return _demo.Until(() => _client.IsConnected, "to be connected");
            yield return _demo.Reset(_client, _twin);
        }

        /// <summary>Waits. If a busy machine has ended it because commands came late, begins again, as a user would.</summary>
        private IEnumerator UntilDriven(System.Func<bool> holds, string what)
        {
            yield return _demo.Until(
                () =>
                {
                    bool isOver = _driver.State == DriveState.Idle || _driver.State == DriveState.Failed;
                    _pointing.TargetPressed = isOver && !holds();
                    return holds();
                },
                what);
        }

        /// <summary>Presses for one frame.</summary>
        private IEnumerator Press(System.Action press)
        {
            press();
            yield return null;
            _pointing.TargetPressed = false;
            _pointing.TeleportPressed = false;
            _pointing.StopPressed = false;
        }
    }
}
