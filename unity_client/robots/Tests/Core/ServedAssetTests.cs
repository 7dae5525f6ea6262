// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;
using NUnit.Framework;
using Ros2Gateway.Robots;

namespace Ros2Gateway.Tests
{
    /// <summary>Assets of a real gateway, whose machine has the package gateway_tests.</summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class ServedAssetTests
    {
        [Test]
        public void AMeshOfManyChunksIsTheFile()
        {
            Reply<byte[]> reply = Fetched("package://gateway_tests/meshes/strip.stl");
            TriangleMesh mesh = StlReader.Read(reply.OrThrow());
            Assert.AreEqual(2000, mesh.TriangleCount); // 100 kB
            for (int i = 0; i < mesh.TriangleCount; i++)
            {
                Assert.AreEqual((float)i, mesh.Corners[9 * i]); // each begins one metre further
            }
        }

        [Test]
        public void AColladaFileIsReadAsItIsServed()
        {
            const string Uri = "package://gateway_tests/meshes/red.dae";
            TriangleMesh mesh = MeshReader.Read(Uri, Fetched(Uri).OrThrow());
            CollectionAssert.AreEqual(new float[] { 0, 0, 1, 1, 0, 1, 0, 2, 1 }, mesh.Corners);
            Assert.AreEqual("#ff0000ff", mesh.Colors[0].ToString());
        }

        [TestCase("package://gateway_tests/meshes/none.stl", "no such file")]
        [TestCase("package://nobody/meshes/strip.stl", "no package nobody")]
        [TestCase("package://gateway_tests/../../strip.stl", "not allowed in the path")]
        [TestCase("https://gateway_tests/strip.stl", "expected package://")]
        public void WhatIsNotServedFailsInTheGatewaysWords(string uri, string words)
        {
            Reply<byte[]> reply = Fetched(uri);
            Assert.IsFalse(reply.Ok);
            StringAssert.Contains(words, reply.Error);
        }

        private static Reply<byte[]> Fetched(string uri)
        {
            using Live live = Live.Connected();
            List<Reply<byte[]>> replies = new();
            live.Client.FetchAsset(uri, replies.Add);
            live.Until(() => replies.Count > 0, "for " + uri);
            return replies[0];
        }
    }
}
