// SPDX-License-Identifier: Apache-2.0
using NUnit.Framework;
using UnityEngine;
using UnityEngine.Stage;

namespace Ros2Gateway.Stage.Tests
{
    [TestFixture]
    public class SceneTest
    {
        private const float Tolerance = 1e-4f;

        private GameObject _parent;
        private GameObject _child;

        [SetUp]
        public void SetUp()
        {
            _parent = new GameObject("parent");
            _child = new GameObject("child");
            _child.transform.parent = _parent.transform;
        }

        [TearDown]
        public void TearDown()
        {
            Object.DestroyImmediate(_parent);
        }

        private static void AreClose(Vector3 expected, Vector3 actual)
        {
            Assert.Less(Vector3.Distance(expected, actual), Tolerance, expected + " expected, got " + actual);
        }

        [Test]
        public void A_child_goes_and_turns_with_its_parent()
        {
            _parent.transform.position = new Vector3(1, 2, 3);
            _parent.transform.rotation = Quaternion.Euler(0, 90, 0);
            _child.transform.localPosition = Vector3.forward;
            AreClose(new Vector3(2, 2, 3), _child.transform.position);
            AreClose(Vector3.right, _child.transform.forward);
        }

        [Test]
        public void A_point_goes_into_a_frame_and_back()
        {
            _parent.transform.position = new Vector3(1, 2, 3);
            _parent.transform.rotation = Quaternion.Euler(10, 20, 30);
            _child.transform.localScale = new Vector3(2, 2, 2);
            _child.transform.localRotation = Quaternion.AngleAxis(40, new Vector3(1, 1, 0));
            var point = new Vector3(4, 5, 6);
            AreClose(point, _child.transform.InverseTransformPoint(_child.transform.TransformPoint(point)));
        }

        [Test]
        public void A_new_parent_leaves_the_child_where_it_is()
        {
            _parent.transform.position = new Vector3(1, 2, 3);
            _child.transform.position = new Vector3(7, 8, 9);
            _child.transform.SetParent(null);
            AreClose(new Vector3(7, 8, 9), _child.transform.localPosition);
            _child.transform.SetParent(_parent.transform, false);
            AreClose(new Vector3(8, 10, 12), _child.transform.position);
        }

        // a left-handed frame: positive turns are clockwise seen from the tip of the axis
        [TestCase(0, 90, 0, 1, 0, 0)]
        [TestCase(90, 0, 0, 0, -1, 0)]
        [TestCase(0, 0, 90, 0, 0, 1)]
        [TestCase(90, 90, 0, 0, -1, 0)]
        public void Turning_forward_by_euler_angles(float x, float y, float z, float toX, float toY,
            float toZ)
        {
            AreClose(new Vector3(toX, toY, toZ), Quaternion.Euler(x, y, z) * Vector3.forward);
        }

        [TestCase(10, 20, 30)]
        [TestCase(350, 200, 120)]
        [TestCase(0, 0, 0)]
        public void Euler_angles_are_found_again(float x, float y, float z)
        {
            AreClose(new Vector3(x, y, z), Quaternion.Euler(x, y, z).eulerAngles);
        }

        [Test]
        public void Looking_along_an_axis_turns_forward_into_it([Values(-1f, 0.5f)] float x,
            [Values(-2f, 0f, 1f)] float z)
        {
            Vector3 direction = new Vector3(x, 0.25f, z).normalized;
            Quaternion look = Quaternion.LookRotation(direction);
            AreClose(direction, look * Vector3.forward);
            Assert.Greater((look * Vector3.up).y, 0f);
        }

        [Test]
        public void A_ray_meets_the_floor()
        {
            GameObject floor = GameObject.CreatePrimitive(PrimitiveType.Plane);
            floor.transform.position = new Vector3(0, 1, 0);
            RaycastHit hit;
            var down = new Ray(new Vector3(1, 3, 0), new Vector3(1, -1, 0));
            Assert.IsTrue(Physics.Raycast(down, out hit, 10f));
            AreClose(new Vector3(3, 1, 0), hit.point);
            AreClose(Vector3.up, hit.normal);
            Assert.AreSame(floor.transform, hit.transform);
            Assert.IsFalse(Physics.Raycast(new Ray(new Vector3(1, 3, 0), Vector3.up), out hit));
            Assert.IsFalse(Physics.Raycast(new Ray(new Vector3(9, 3, 0), Vector3.down), out hit));
            Object.DestroyImmediate(floor);
        }

        [Test]
        public void An_image_gives_a_texture_its_size()
        {
            var texture = new Texture2D(2, 2);
            Assert.IsFalse(texture.LoadImage(new byte[] { 1, 2, 3 }));
            var large = new Texture2D(321, 123);
            Assert.IsTrue(texture.LoadImage(large.EncodeToJPG(80)));
            Assert.AreEqual(321, texture.width);
            Assert.AreEqual(123, texture.height);
        }

        [Test]
        public void Keys_are_down_for_one_frame_and_held_until_released()
        {
            Keyboard.Press(KeyCode.W);
            Assert.IsTrue(Input.GetKeyDown(KeyCode.W));
            PlayerLoop.Step();
            Assert.IsFalse(Input.GetKeyDown(KeyCode.W));
            Assert.IsTrue(Input.GetKey(KeyCode.W));
            Keyboard.Release(KeyCode.W);
            Assert.IsFalse(Input.GetKey(KeyCode.W));
        }

        [Test]
        public void A_frame_of_idle_components_allocates_nothing()
        {
            _child.AddComponent<Idle>();
            for (int i = 0; i < 100; i++)
            {
                PlayerLoop.Step();
            }
            long before = System.GC.GetTotalMemory(false);
            for (int i = 0; i < 1000; i++)
            {
                PlayerLoop.Step();
            }
            Assert.Less(System.GC.GetTotalMemory(false) - before, 1000 * 8);
        }
    }

    public class Idle : MonoBehaviour
    {
        private void Update()
        {
            transform.localPosition += Vector3.forward * Time.deltaTime;
        }
    }
}
