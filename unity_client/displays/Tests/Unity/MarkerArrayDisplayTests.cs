// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections;
using System.Threading;
using NUnit.Framework;
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Messages.StdMsgs;
using Ros2Gateway.Messages.VisualizationMsgs;
using UnityEngine;
using UnityEngine.TestTools;
using Object = UnityEngine.Object;

namespace Ros2Gateway.Unity.Tests
{
    [TestFixture]
    public sealed class MarkerArrayDisplayTests
    {
        private const int TimeoutMilliseconds = 60000; // a machine may be busy with other things

        private DisplayScene _scene;
        private MarkerArrayDisplay _display;

        [SetUp]
        public void SetUp()
        {
            _scene = new DisplayScene();
            _display = _scene.Display<MarkerArrayDisplay>();
        }

        [TearDown]
        public void TearDown() => _scene.Dispose();

        [UnityTest]
        public IEnumerator MessagesOfOneFrameAllCount()
        {
            Show(Marker("a", 1));
            Show(Marker("a", 2));
            Show(Marker("b", 1));
            yield return null;
            Assert.AreEqual(3, _display.Count);
            Transform first = _display.transform.GetChild(0);
            Assert.AreEqual("a/1", first.name);
            Assert.AreEqual(24, first.GetComponent<MeshFilter>().sharedMesh.vertexCount);
            Assert.AreEqual(new Vector3(-2, 3, 1), first.localPosition);
            Assert.AreSame(
                first.GetComponent<MeshRenderer>().sharedMaterial,
                _display.transform.GetChild(1).GetComponent<MeshRenderer>().sharedMaterial, "all share one");
        }

        [UnityTest]
        public IEnumerator TheSameNameChangesAMarkerAndActionsTakeItAway()
        {
            Show(Marker("a", 1), Marker("a", 2), Marker("b", 1));
            yield return null;
            MarkerMsg changed = Marker("a", 1);
            changed.type = MarkerMsg.SPHERE;
            Show(changed);
            yield return null;
            Assert.AreEqual(3, _display.Count);
            Assert.AreEqual(153, _display.transform.GetChild(0).GetComponent<MeshFilter>().sharedMesh.vertexCount);
            Show(Action("a", 1, MarkerMsg.DELETE), Action("nobody", 7, MarkerMsg.DELETE));
            yield return null;
            Assert.AreEqual(2, _display.Count);
            Show(Action("", 0, MarkerMsg.DELETEALL), Marker("c", 1));
            yield return null;
            Assert.AreEqual(1, _display.Count);
            yield return null; // objects go at the end of a frame
            Assert.AreEqual(1, _display.transform.childCount);
        }

        [UnityTest]
        public IEnumerator AMarkerLivesAsLongAsItSays()
        {
            MarkerMsg brief = Marker("brief", 1);
            brief.lifetime.nanosec = 50000000;
            Show(brief, Marker("lasting", 1));
            yield return null;
            Assert.AreEqual(2, _display.Count);
            yield return _scene.Until(() => _display.Count == 1, "for the end of one");
        }

        [UnityTest]
        public IEnumerator ATextFacesTheCamera()
        {
            GameObject eye = new("eye", typeof(Camera)) { tag = "MainCamera" };
            eye.transform.rotation = Quaternion.Euler(0, 70, 0);
            MarkerMsg marker = Marker("t", 1);
            marker.type = MarkerMsg.TEXT_VIEW_FACING;
            marker.text = "<b>hello</b>";
            marker.scale.z = 0.5;
            Show(marker);
            yield return null;
            TextMesh text = _display.GetComponentInChildren<TextMesh>();
            Assert.AreEqual("<b>hello</b>", text.text);
            Assert.IsFalse(text.richText);
            Assert.Less(Quaternion.Angle(eye.transform.rotation, text.transform.rotation), 0.01f);
            marker.type = MarkerMsg.CUBE;
            Show(marker);
            yield return null;
            yield return null;
            Assert.IsNull(_display.GetComponentInChildren<TextMesh>());
            Object.DestroyImmediate(eye);
        }

        [UnityTest]
        public IEnumerator MarkersAreBoundedAndWhatIsWrongIsSaidOnce()
        {
            LogAssert.Expect(LogType.Warning, new System.Text.RegularExpressions.Regex("at most 2 markers"));
            LogAssert.Expect(LogType.Warning, new System.Text.RegularExpressions.Regex("type 99 is unknown"));
            LogAssert.Expect(LogType.Warning, new System.Text.RegularExpressions.Regex("pose is not finite"));
            LogAssert.Expect(LogType.Warning, new System.Text.RegularExpressions.Regex("action 17 is unknown"));
            _display.MaxMarkers = 2;
            MarkerMsg unknown = Marker("a", 1);
            unknown.type = 99;
            MarkerMsg nowhere = Marker("a", 2);
            nowhere.pose.position.x = double.NaN;
            Show(unknown, nowhere, Marker("a", 3), Action("a", 4, 17), null);
            _display.Show(new MarkerArrayMsg { markers = null });
            yield return null;
            Assert.AreEqual(2, _display.Count);
            Assert.IsFalse(_display.transform.GetChild(1).gameObject.activeSelf);
        }

        [UnityTest]
        public IEnumerator VerticesOfAllMarkersAreBounded()
        {
            LogAssert.Expect(LogType.Warning, new System.Text.RegularExpressions.Regex("more than 36 vertices"));
            LogAssert.Expect(LogType.Warning, new System.Text.RegularExpressions.Regex("more than 12 vertices"));
            _display.MaxVertices = 60; // two cubes have 48
            Show(Marker("a", 1), Cubes("a", 2, 2));
            yield return null;
            Assert.AreEqual(24, VerticesOf(1), "one of the two cubes");
            Show(Cubes("a", 3, 1));
            yield return null;
            Assert.AreEqual(0, VerticesOf(2));
            Show(Action("a", 1, MarkerMsg.DELETE), Cubes("a", 2, 2));
            yield return null;
            yield return null; // objects go at the end of a frame
            Assert.AreEqual(48, VerticesOf(0), "there is room again");
            Show(Action("", 0, MarkerMsg.DELETEALL), Cubes("a", 4, 2));
            yield return null;
            yield return null;
            Assert.AreEqual(48, VerticesOf(0));
        }

        [UnityTest]
        public IEnumerator EachMarkerKeepsItsMeshAlone()
        {
            const int Markers = 8, Boxes = 2000;
            const int MeshBytes = Boxes * (24 * (12 + 4) + 36 * 4); // positions, colours, indices
            Show(Cubes("a", 0, Boxes));
            yield return null;
            long before = GC.GetTotalMemory(true);
            for (int i = 1; i <= Markers; i++)
            {
                Show(Cubes("a", i, Boxes));
            }
            yield return null;
            long kept = GC.GetTotalMemory(true) - before;
            Assert.AreEqual(1 + Markers, _display.Count);
            Assert.Less(kept, Markers * MeshBytes * 3 / 2, "what meshes are uploaded from is shared");
        }

        [UnityTest]
        public IEnumerator WhileItIsDisabledNothingIsAdded()
        {
            _display.enabled = false;
            Show(Marker("a", 1));
            _display.enabled = true;
            yield return null;
            Assert.AreEqual(0, _display.Count);
            Assert.IsTrue(float.IsInfinity(_display.AgeSeconds));
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator ABurstIsShownWholeThoughItsMessagesAreFilledAnew()
        {
            _scene.Connect();
            MarkerArrayDisplay display = _scene.Display<MarkerArrayDisplay>(
                "/markers_of_a_burst", MarkerArrayMsg.Type, made => made.GetComponent<TopicSubscriber>().Reuse = true);
            using GatewayClient other = _scene.OtherProgram();
            other.Connect();
            Publisher<MarkerArrayMsg> markers = other.Advertise<MarkerArrayMsg>("/markers_of_a_burst");
            Action<int> send = id => markers.Publish(
                new MarkerArrayMsg { markers = new[] { Marker("a", id) } }, evenLate: true);
            int arrived = 0, heard = 0;
            display.Subscriber.MessageArriving += message => Interlocked.Increment(ref arrived);
            yield return _scene.Until(() => other.IsConnected, "for the other client", () => other.Pump());
            yield return _scene.Until(() => display.Count == 1, "for the first marker", () => send(0));
            send(1);
            yield return _scene.Until(() => display.Count == 2, "for what was sent before");
            display.Clear();
            int before = arrived;
            display.Subscriber.MessageReceived += message =>
            {
                if (++heard == 3) // in Pump: what comes now is read into the messages that were the handlers' before
                {
                    send(14);
                    send(15);
                    SpinWait.SpinUntil(() => arrived >= before + 5, TimeoutMilliseconds);
                }
            };
            send(11);
            send(12);
            send(13);
            SpinWait.SpinUntil(() => arrived >= before + 3, TimeoutMilliseconds);
            yield return _scene.Until(() => heard == 5, "for the burst");
            yield return null;
            Assert.AreEqual(5, display.Count);
        }

        [UnityTest]
        public IEnumerator DisablingItTakesAllMarkersAway()
        {
            Show(Marker("a", 1));
            yield return null;
            _display.enabled = false;
            Assert.AreEqual(0, _display.Count);
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator EachMarkerStandsInItsOwnFrame()
        {
            LogAssert.ignoreFailingMessages = true; // nobody knows one of the frames
            _scene.Connect();
            FixedFrame origin = _scene.Fixed("base_link");
            MarkerArrayDisplay display = _scene.Display<MarkerArrayDisplay>(
                setUp: made => made.transform.SetParent(origin.transform, false));
            MarkerMsg here = Marker("here", 1), there = Marker("there", 1), nowhere = Marker("nowhere", 1);
            here.header.frame_id = "base_link";
            there.header.frame_id = "base_scan";
            nowhere.header.frame_id = "nobody";
            display.Show(new MarkerArrayMsg { markers = new[] { here, there, nowhere } });
            yield return _scene.Until(
                () => display.Count == 3 && display.transform.GetChild(1).gameObject.activeSelf, "for the frame");
            Assert.AreEqual(3, display.transform.GetChild(0).position.y, 1e-5);
            Assert.AreEqual(3.122f, display.transform.GetChild(1).position.y, 1e-5);
            Assert.IsFalse(display.transform.GetChild(2).gameObject.activeSelf);
        }

        [UnityTest]
        [Category("Gateway")]
        public IEnumerator EnabledAgainItBeginsWithTheLastMessage()
        {
            GatewayClient client = _scene.Connect().Client;
            MarkerArrayDisplay display = _scene.Display<MarkerArrayDisplay>("/markers_of_before", MarkerArrayMsg.Type);
            Publisher<MarkerArrayMsg> markers = client.Advertise<MarkerArrayMsg>("/markers_of_before");
            MarkerArrayMsg pair = new() { markers = new[] { Marker("a", 1), Marker("a", 2) } };
            yield return _scene.Until(() => client.IsConnected, "to be connected");
            yield return _scene.Until(
                () => display.Count == 2, "for the markers", () => markers.Publish(pair, evenLate: true));
            display.enabled = false;
            yield return null;
            Assert.AreEqual(0, display.Count);
            markers.Dispose();
            yield return _scene.Until(() => Time.unscaledTime - display.Subscriber.LastTime > 0.5f, "for silence");
            display.enabled = true;
            yield return null;
            yield return null;
            Assert.AreEqual(2, display.Count);
            Assert.Greater(display.AgeSeconds, 0.5f);
            display.enabled = false;
            display.gameObject.SetActive(false);
            display.gameObject.SetActive(true);
            display.enabled = true;
            yield return null;
            yield return null;
            Assert.AreEqual(0, display.Count, "the message is not of this subscription");
        }

        private void Show(params MarkerMsg[] markers) => _display.Show(new MarkerArrayMsg { markers = markers });

        private static MarkerMsg Marker(string space, int id)
        {
            MarkerMsg marker = new()
            {
                ns = space, id = id, type = MarkerMsg.CUBE, color = new ColorRGBAMsg { r = 1, g = 1, b = 1, a = 1 },
            };
            marker.scale.x = marker.scale.y = marker.scale.z = 1;
            marker.pose.position.x = 1;
            marker.pose.position.y = 2;
            marker.pose.position.z = 3;
            return marker;
        }

        private static MarkerMsg Cubes(string space, int id, int count)
        {
            MarkerMsg marker = Marker(space, id);
            marker.type = MarkerMsg.CUBE_LIST;
            marker.points = new PointMsg[count];
            for (int i = 0; i < count; i++)
            {
                marker.points[i] = new PointMsg { x = i };
            }
            return marker;
        }

        private int VerticesOf(int child) =>
            _display.transform.GetChild(child).GetComponent<MeshFilter>().sharedMesh.vertexCount;

        private static MarkerMsg Action(string space, int id, int action) =>
            new MarkerMsg { ns = space, id = id, action = action };
    }
}
