// SPDX-License-Identifier: Apache-2.0
using System.Collections;
using NUnit.Framework;
using UnityEngine;
using UnityEngine.TestTools;

namespace Ros2Gateway.Unity.Tests
{
    [TestFixture]
    public sealed class DemonstrationSceneTests
    {
        private DisplayScene _scene;

        [SetUp]
        public void SetUp() => _scene = new DisplayScene();

        [TearDown]
        public void TearDown() => _scene.Dispose();

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator ItLeavesNoMaterialsBehindAndItsScreenIsUnlit()
        {
            LogAssert.ignoreFailingMessages = true; // nobody publishes the pictures
            _scene.Connect();
            GameObject holder = _scene.Inactive("scene");
            Pieces pieces = holder.AddComponent<Pieces>();
            holder.SetActive(true);
            Material material = pieces.Piece.GetComponent<Renderer>().sharedMaterial;
            Assert.AreEqual(Color.yellow, material.color);
            Renderer screen = holder.GetComponentInChildren<ImageScreen>().GetComponent<Renderer>();
            Assert.AreEqual("Sprites/Default", screen.sharedMaterial.shader.name);
            Object.Destroy(holder);
            yield return null;
            yield return null;
            Assert.IsTrue(material == null, "it is still there");
        }

        private sealed class Pieces : DemonstrationScene
        {
            internal GameObject Piece { get; private set; }

            protected override void Build()
            {
                Piece = Part(PrimitiveType.Cube, "Piece", transform, Vector3.zero, Vector3.one, Color.yellow);
                BuildImageScreen(Vector3.up);
            }
        }
    }
}
