// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Threading;
using System.Threading.Tasks;
using NUnit.Framework;
using Ros2Gateway.Json;

namespace Ros2Gateway.Tests
{
    /// <summary>Assets in chunks, from a gateway that a test plays.</summary>
    [TestFixture]
    public sealed class AssetTests
    {
        private const string Uri = "package://arm/meshes/upper.stl";

        private readonly List<GatewayEvent> _events = new();
        private readonly List<Reply<byte[]>> _replies = new();
        private StuckTransport _network;
        private GatewayClient _client;

        [SetUp]
        public void SetUp()
        {
            _events.Clear();
            _replies.Clear();
            _network = new StuckTransport();
            _client = new GatewayClient(new GatewayOptions { Transport = options => _network, UsesThreads = false });
            _client.EventHeard += _events.Add;
            _client.Connect();
        }

        [TearDown]
        public void TearDown() => _client.Dispose();

        [Test]
        public void AnAssetIsAskedForInChunksOneAtATime()
        {
            _client.FetchAsset(Uri, _replies.Add);
            Assert.AreEqual(1, Asked().Count);
            Assert.AreEqual(Uri, Asked()[0]["uri"].AsString(""));
            Assert.AreEqual(0, Asked()[0]["offset"].AsLong(-1));
            Answer(0, 5, 1, 2);
            Assert.AreEqual(2, Asked().Count);
            Assert.AreEqual(2, Asked()[1]["offset"].AsLong(-1));
            Answer(2, 5, 3, 4);
            Assert.AreEqual(0, _replies.Count);
            Answer(4, 5, 5);
            Assert.AreEqual(3, Asked().Count);
            Assert.AreEqual(1, _replies.Count);
            CollectionAssert.AreEqual(new byte[] { 1, 2, 3, 4, 5 }, _replies[0].OrThrow());
            Assert.AreEqual(0, _client.PendingRequests);
            Assert.IsFalse(_events.Exists(one => one.Level != EventLevel.Info), string.Join(" | ", _events));
        }

        [Test]
        public void AnEmptyAssetIsOne()
        {
            _client.FetchAsset(Uri, _replies.Add);
            Answer(0, 0);
            Assert.AreEqual(0, _replies[0].OrThrow().Length);
        }

        [Test]
        public void WhatTheGatewayRefusesFailsInItsWords()
        {
            _client.FetchAsset(Uri, _replies.Add);
            Answer(0, 5, 1);
            Receive("{\"op\":\"status\",\"level\":\"error\",\"id\":\"" + LastId() + "\",\"code\":\"not_found\","
                + "\"request\":\"fetch_asset\",\"msg\":\"there is no such file\"}");
            Fails("there is no such file");
        }

        [TestCase(0, 64 * 1024 * 1024 + 1, "the asset has 67108865 bytes, at most 67108864")]
        [TestCase(0, -1, "negative")]
        [TestCase(-1, 5, "negative")]
        [TestCase(1, 5, "asked for the bytes from offset 0, got those from 1")]
        [TestCase(0, 1, "got 2 bytes from offset 0, the asset has 1")]
        public void AFirstChunkThatIsWrongIsRefused(int offset, int size, string words)
        {
            _client.FetchAsset(Uri, _replies.Add);
            Answer(offset, size, 1, 2);
            Fails(words);
        }

        [Test]
        public void AnAssetOf64MebibytesIsTaken()
        {
            _client.FetchAsset(Uri, _replies.Add);
            Answer(0, 64 * 1024 * 1024, 1, 2);
            Assert.AreEqual(0, _replies.Count);
            Assert.AreEqual(2, Asked()[1]["offset"].AsLong(-1));
        }

        [TestCase(2, 6, 1, "the asset's size changed from 5 to 6 bytes while it was fetched")]
        [TestCase(0, 5, 2, "asked for the bytes from offset 2, got those from 0")]
        [TestCase(3, 5, 2, "asked for the bytes from offset 2, got those from 3")]
        [TestCase(2, 5, 0, "got no bytes from offset 2, the asset has 5")]
        [TestCase(2, 5, 4, "got 4 bytes from offset 2, the asset has 5")]
        public void AChunkThatDoesNotGoOnIsRefused(int offset, int size, int count, string words)
        {
            _client.FetchAsset(Uri, _replies.Add);
            Answer(0, 5, 1, 2);
            Answer(offset, size, new byte[count]);
            Fails(words);
        }

        [TestCase("\"offset\":0,\"size\":5", "no offset, size or data")]
        [TestCase("\"offset\":0,\"data\":\"AQI=\"", "no offset, size or data")]
        [TestCase("\"size\":5,\"data\":\"AQI=\"", "no offset, size or data")]
        [TestCase("\"offset\":0,\"size\":5,\"data\":\"?\"", "answer cannot be read: data: expected base64")]
        [TestCase("\"offset\":0,\"size\":1e30,\"data\":\"AQI=\"", "answer cannot be read")]
        public void AnAnswerThatIsNoneFails(string members, string words)
        {
            _client.FetchAsset(Uri, _replies.Add);
            Receive("{\"op\":\"fetch_asset\",\"id\":\"" + LastId() + "\"," + members + "}");
            Fails(words);
        }

        [Test]
        public void SeveralAssetsMayBeUnderWay()
        {
            Task<byte[]> first = _client.FetchAssetAsync("package://arm/a.stl");
            string id = LastId();
            Task<byte[]> second = _client.FetchAssetAsync("package://arm/b.stl");
            Answer(0, 1, 7);
            Assert.IsFalse(first.IsCompleted);
            Receive("{\"op\":\"fetch_asset\",\"id\":\"" + id + "\",\"offset\":0,\"size\":1,\"data\":\"AQ==\"}");
            Assert.IsTrue(first.IsCompleted && second.IsCompleted);
            CollectionAssert.AreEqual(new byte[] { 7 }, second.Result);
            CollectionAssert.AreEqual(new byte[] { 1 }, first.Result);
        }

        [Test]
        public void AnAwaitedFetchThatFailsSaysWhatItWas()
        {
            Task<byte[]> fetch = _client.FetchAssetAsync(Uri);
            Answer(1, 5, 1);
            Assert.IsTrue(fetch.IsFaulted);
            Exception error = Assert.Throws<GatewayException>(() => fetch.GetAwaiter().GetResult());
            Assert.AreEqual("fetch_asset " + Uri + ": asked for the bytes from offset 0, got those from 1", error.Message);
        }

        [Test]
        public void ChunksDoNotWaitForThePump()
        {
            _client.FetchAsset(Uri, _replies.Add);
            _network.Receive(Chunk(0, 3, 1));
            _network.Receive(Chunk(1, 3, 2));
            Assert.AreEqual(3, Asked().Count);
            _network.Receive(Chunk(2, 3, 3));
            Assert.AreEqual(0, _replies.Count);
            _client.Pump();
            CollectionAssert.AreEqual(new byte[] { 1, 2, 3 }, _replies[0].OrThrow());
        }

        [TestCase(2)]
        [TestCase(5)]
        public void ACancelledFetchAsksForNoMore(int size)
        {
            using (CancellationTokenSource cancellation = new())
            {
                Task<byte[]> fetch = _client.FetchAssetAsync(Uri, cancellation.Token);
                Answer(0, size, 1);
                _network.Receive(Chunk(1, size, 2)); // of 2 bytes the last, which waits for the pump
                int asked = Asked().Count;
                cancellation.Cancel();
                Assert.AreEqual(0, _client.PendingRequests);
                Assert.IsFalse(fetch.IsCompleted, "goes on in the pump only");
                Answer(2, size, 3);
                Assert.IsTrue(fetch.IsCanceled);
                Assert.AreEqual(asked, Asked().Count);
            }
            Assert.IsTrue(_client.FetchAssetAsync(Uri, new CancellationToken(true)).IsCanceled);
            Assert.AreEqual(0, _client.PendingRequests);
        }

        [Test]
        public void ALostConnectionAndADisposedClientEndAFetch()
        {
            _client.FetchAsset(Uri, _replies.Add);
            Answer(0, 5, 1);
            Task<byte[]> awaited = _client.FetchAssetAsync(Uri);
            _client.Disconnect();
            _client.Pump();
            Assert.AreEqual(1, _replies.Count);
            Assert.IsFalse(_replies[0].Ok);
            Assert.IsTrue(awaited.IsFaulted);
            _client.Connect();
            awaited = _client.FetchAssetAsync(Uri);
            _client.Dispose();
            Assert.IsTrue(awaited.IsFaulted);
            StringAssert.Contains("disposed", awaited.Exception.InnerException.Message);
        }

        private void Fails(string words)
        {
            Assert.AreEqual(1, _replies.Count);
            Assert.IsFalse(_replies[0].Ok);
            StringAssert.Contains(words, _replies[0].Error);
            _client.Pump(); // events are told before what is answered
            Assert.AreEqual(1, _events.FindAll(one => one.Request == "fetch_asset " + Uri && one.Text.Contains(words)).Count);
            Assert.AreEqual(0, _client.PendingRequests);
        }

        private void Answer(long offset, long size, params byte[] data) => Receive(Chunk(offset, size, data));

        private string Chunk(long offset, long size, params byte[] data) =>
            "{\"op\":\"fetch_asset\",\"id\":\"" + LastId() + "\",\"uri\":\"" + Uri + "\",\"offset\":" + offset
                + ",\"size\":" + size + ",\"data\":\"" + Convert.ToBase64String(data) + "\"}";

        private void Receive(string frame)
        {
            _network.Receive(frame);
            _client.Pump();
        }

        private string LastId()
        {
            List<JsonValue> asked = Asked();
            return asked[asked.Count - 1]["id"].AsString("");
        }

        private List<JsonValue> Asked() =>
            _network.Sent.ConvertAll(JsonValue.Parse).FindAll(frame => frame["op"].AsString("") == "fetch_asset");
    }
}
