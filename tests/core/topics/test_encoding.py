# SPDX-License-Identifier: Apache-2.0
import base64
import json
from concurrent.futures import Future
from typing import Any

import cbor2
import cv2
import numpy as np
import pytest

from gateway.core.entries import NOT_READY
from gateway.core.topics.encoding import PerClientFrame, SharedFrame, WorkerEncoding
from gateway.core.topics.large_samples import EncodedTopic
from gateway.core.topics.subscription import EncodingKey
from gateway.fronts.rosbridge.framing import RosbridgeFraming
from gateway.sources.source import Sample
from tests.client import eventually
from tests.core.conftest import GRID, IMAGE, SCAN, STRING, Bench
from tests.wire import untagged, websocket_frames

ROS_SHARP = 2**31 - 1
PIXELS = {"height": 48, "width": 64, "encoding": "mono8", "step": 64, "data": [128] * 48 * 64}


def text_in(picture: str) -> str:
    pixels = cv2.imdecode(np.frombuffer(base64.b64decode(picture), np.uint8), cv2.IMREAD_COLOR)
    assert pixels is not None
    return cv2.cvtColor(pixels, cv2.COLOR_BGR2RGB).tobytes().decode()


async def received(bench: Bench, cdr: bytes, type_name: str, **options):
    client = bench.listener("/t", type_name, **options)
    bench.ros.publish("/t", cdr)
    (frame,) = await client.sees(1)
    return frame, client


async def test_cbor_has_typed_arrays_and_byte_strings(bench: Bench):
    cdr = bench.cdr(SCAN, ranges=[1.0, 2.5], angle_min=0.1)
    frame, _ = await received(bench, cdr, SCAN, compression="cbor")
    assert (frame["op"], frame["topic"]) == ("publish", "/t")
    assert frame["msg"]["ranges"] == cbor2.CBORTag(85, np.array([1.0, 2.5], "<f4").tobytes())
    assert frame["msg"]["intensities"] == cbor2.CBORTag(85, b"")


async def test_cbor_has_the_fields_that_were_asked_for(bench: Bench):
    cdr = bench.cdr(SCAN, ranges=[1.0])
    frame, _ = await received(bench, cdr, SCAN, compression="cbor", fields=["ranges"], meta=True)
    assert untagged(frame["msg"]) == {"ranges": [1.0]}
    assert (frame["seq"], frame["dropped"]) == (1, 0)


async def test_cbor_raw_is_the_sample_untouched_with_the_time(bench: Bench):
    cdr = bench.cdr(STRING, data="hello")
    frame, _ = await received(bench, cdr, STRING, compression="cbor-raw")
    now_s = bench.ros.now_ns() // 10**9
    assert frame["msg"]["bytes"] == cdr
    assert set(frame["msg"]) == {"secs", "nsecs", "bytes"}
    assert abs(frame["msg"]["secs"] - now_s) < 60
    assert 0 <= frame["msg"]["nsecs"] < 10**9


async def test_an_image_as_cbor_is_a_jpeg_without_base64(bench: Bench):
    cdr = bench.cdr(IMAGE, **PIXELS)
    frame, _ = await received(
        bench, cdr, IMAGE, compression="cbor", image={"max_width": 32, "quality": 50}
    )
    message = frame["msg"]
    assert (message["format"], message["width"], message["height"]) == ("jpeg", 32, 24)
    assert message["data"].startswith(b"\xff\xd8")
    assert message["header"]["frame_id"] == ""


async def test_an_image_as_cbor_can_be_plain(bench: Bench):
    cdr = bench.cdr(IMAGE, **PIXELS)
    frame, _ = await received(bench, cdr, IMAGE, compression="cbor", image={"format": "raw"})
    assert frame["msg"]["data"] == bytes([128]) * 48 * 64


async def test_an_image_as_cbor_raw_is_a_plain_message(bench: Bench):
    cdr = bench.cdr(IMAGE, **PIXELS)
    frame, _ = await received(bench, cdr, IMAGE, compression="cbor-raw")
    assert frame["msg"]["bytes"] == cdr


async def test_png_hides_a_publish_frame_in_ascii(bench: Bench):
    client = bench.listener("/t", STRING, compression="png", meta=True)
    bench.say("/t", "größe")
    (frame,) = await client.sees(1, "png")
    text = text_in(frame["data"])
    assert text.isascii()
    assert json.loads(text) == {"op": "publish", "topic": "/t", "msg": {"data": "größe"}}
    assert (frame["seq"], frame["dropped"]) == (1, 0)


async def test_png_holds_pictures_as_json_does(bench: Bench):
    client = bench.listener("/t", IMAGE, compression="png")
    bench.ros.publish("/t", bench.cdr(IMAGE, **PIXELS))
    (frame,) = await client.sees(1, "png")
    assert json.loads(text_in(frame["data"]))["msg"]["format"] == "jpeg"


async def test_fields_of_cbor_compile_nothing_for_json(bench: Bench):
    bench.ros.add_publisher("/t", SCAN)
    bench.client().send(op="subscribe", topic="/t", compression="cbor", fields=["ranges"])
    assert bench.types.get(SCAN)._compiled.cache_info().currsize == 1  # the one to CBOR


@pytest.mark.parametrize("compression", ["none", "cbor"])
@pytest.mark.parametrize("side", [48, 4096])
async def test_no_fields_say_that_samples_come_and_decode_nothing(
    bench: Bench, compression: str, side: int
):
    cdr = bench.cdr(IMAGE, **PIXELS)[: -(48 * 64)] + bytes(side * side)  # too large: not looked at
    frame, client = await received(
        bench, cdr, IMAGE, compression=compression, fields=[], meta=True, throttle_rate=1
    )
    assert frame["msg"] == {}
    assert (frame["seq"], frame["size"]) == (1, len(cdr))
    assert bench.types.get(IMAGE)._compiled.cache_info().currsize == 0
    assert not client.statuses


async def test_no_fields_are_possible_as_png_too(bench: Bench):
    client = bench.listener("/t", STRING, compression="png", fields=[], meta=True)
    bench.say("/t", "hello")
    (frame,) = await client.sees(1, "png")
    assert json.loads(text_in(frame["data"])) == {"op": "publish", "topic": "/t", "msg": {}}
    assert frame["size"] == len(bench.cdr(STRING, data="hello"))


async def test_no_fields_give_way_to_those_that_another_request_asks_for(bench: Bench):
    bench.ros.add_publisher("/t", STRING)
    client = bench.sender(op="subscribe", id="a", topic="/t", fields=[])
    client.send(op="subscribe", id="b", topic="/t", fields=["data"])
    bench.say("/t", "hello")
    assert (await client.sees(1))[0]["msg"] == {"data": "hello"}


@pytest.mark.parametrize("fields", [["data"], []])
@pytest.mark.parametrize("knows_topic", [True, False])
async def test_fields_of_cbor_raw_are_refused(bench: Bench, fields: list[str], knows_topic: bool):
    if knows_topic:
        bench.ros.add_publisher("/t", STRING)
    client = bench.sender(op="subscribe", topic="/t", compression="cbor-raw", fields=fields)
    assert client.statuses == [
        ("bad_request", "fields: cbor-raw sends whole messages, use cbor to select fields")
    ]
    assert bench.ros.entity_count() == 0


async def test_clients_with_the_same_compression_share_bytes(bench: Bench):
    bench.ros.add_publisher("/t", STRING)
    compressions = ("cbor", "cbor", "none", None, "cbor-raw")
    clients = [bench.client() for _ in compressions]
    for client, compression in zip(clients, compressions, strict=True):
        client.send(op="subscribe", topic="/t", compression=compression)
    bench.say("/t", "x")
    for client in clients:
        await client.sees(1)
    cbor, same_cbor, plain, same_plain, raw = (client.wires[-1] for client in clients)
    assert cbor is same_cbor
    assert plain is same_plain
    assert len({cbor, plain, raw}) == 3


@pytest.mark.parametrize("compression", ["none", "png", "cbor"])
@pytest.mark.parametrize("plain_first", [True, False])
async def test_a_sample_is_encoded_once_for_shared_and_per_client_frames(
    bench: Bench, compression, plain_first
):
    bench.ros.add_publisher("/t", STRING)
    clients = [bench.client() for _ in range(4)]
    metas = [False, True, False, True] if plain_first else [True, False, True, False]
    for client, meta in zip(clients, metas, strict=True):
        client.send(op="subscribe", topic="/t", compression=compression, meta=meta)
        client.is_paused = True
    bench.say("/t", "x")
    await bench.settle()
    (queue,) = clients[0].session.outbox._queues
    entry = queue.waiting[0]
    shared = entry._shared if isinstance(entry, PerClientFrame) else entry
    assert isinstance(shared, SharedFrame)
    encoded = []
    encode = shared.encoding._encode

    def counting(cdr: bytes) -> bytes:
        encoded.append(cdr)
        return encode(cdr)

    shared.encoding._encode = counting
    op = "png" if compression == "png" else "publish"
    for client in clients:
        client.resume()
        (seen,) = await client.sees(1, op)
        assert ("seq" in seen) == metas[clients.index(client)]
        # it holds only one of the three
        held = (shared.sample.cdr, isinstance(shared._message, bytes), shared._frame)
        assert sum(map(bool, held)) == 1
    assert len(encoded) == 1


async def test_a_subscription_gets_fragments_that_asked_and_the_others_do_not(bench: Bench):
    bench.ros.add_publisher("/t", STRING)
    cut, whole = bench.client(), bench.client()
    cut.send(op="subscribe", topic="/t", fragment_size=100)
    whole.send(op="subscribe", topic="/t")
    bench.say("/t", "short", "ü" * 150, "x" * 150)
    await whole.sees(3)
    assert await cut.sees(1) == [{"op": "publish", "topic": "/t", "msg": {"data": "short"}}]
    pieces = await cut.sees(4, "fragment")
    texts: dict[str, str] = {}
    for piece in pieces:
        assert len(piece["data"]) <= 100
        assert piece["total"] == 2
        texts[piece["id"]] = texts.get(piece["id"], "") + piece["data"]
    assert [json.loads(text)["msg"]["data"][:2] for text in texts.values()] == ["üü", "xx"]


async def test_ros_sharp_gets_escapes_and_the_others_utf_8(bench: Bench):
    bench.ros.add_publisher("/t", STRING)
    ros_sharp, other = bench.client(), bench.client()
    other.send(op="subscribe", topic="/t")
    ros_sharp.send(
        op="subscribe", topic="/t", compression="none", fragment_size=ROS_SHARP, queue_length=0
    )
    bench.ros.publish("/t", bench.cdr(STRING, data="größe \U0001f916" + "x" * 100_000))
    for client in (ros_sharp, other):
        assert (await client.sees(1))[0]["msg"]["data"].startswith("größe \U0001f916")
    (frame,) = websocket_frames(ros_sharp.wires[-1])
    assert bytes(frame.data).isascii()
    assert not other.wires[-1][10:].isascii()


async def test_a_subscription_from_before_the_fingerprint_is_escaped_too(bench: Bench):
    client = bench.listener("/t", STRING)
    client.send(op="ping", fragment_size=ROS_SHARP)
    bench.say("/t", "größe")
    await client.sees(1)
    (frame,) = websocket_frames(client.wires[-1])
    assert bytes(frame.data).isascii()


@pytest.mark.parametrize("compression", ["none", "png", "cbor"])
async def test_a_sample_that_cannot_be_decoded_is_reported_once(bench: Bench, compression):
    client = bench.listener("/t", STRING, compression=compression)
    for _ in range(3):
        bench.ros.publish("/t", b"\0\1\0\0\xff\0\0\0")
    bench.say("/t", "harmed by nothing")
    await client.sees(1, "png" if compression == "png" else "publish")
    assert [code for code, _ in client.statuses] == ["invalid_value"]


async def test_a_fault_of_a_worker_is_logged_with_the_resolved_name(bench: Bench, caplog):
    bench.ros.add_publisher("/t", STRING)
    bench.sender(op="subscribe", topic="t", compression="png")
    (topic,) = bench.router._subscriptions._topics.values()
    (encoding,) = topic._encodings.values()
    encoding._encode = lambda cdr: bytes(1 // 0)
    bench.say("/t", "x")
    await eventually(lambda: bool(caplog.records))
    (record,) = caplog.records
    assert (record.getMessage(), record.topic) == ("encoding a sample failed", "/t")


class Workers:
    """An executor whose work a test finishes by hand."""

    def __init__(self) -> None:
        self.futures: list[Future[bytes]] = []

    def submit(self, *_: object) -> "Future[bytes]":
        self.futures.append(Future())
        return self.futures[-1]


async def test_one_sample_is_encoded_at_a_time():
    workers: Any = Workers()
    key = EncodingKey(RosbridgeFraming(), "/camera", None, None)
    ready: list[None] = []
    topic = EncodedTopic("/camera", lambda: ready.append(None), lambda: False, lambda: 0)
    encoding = WorkerEncoding(key, bytes, lambda error: None, topic, workers)
    one, other = (SharedFrame(encoding, Sample(b"cdr", 0), seq) for seq in (1, 2))
    assert [each.frame() for each in (one, other, one, other)] == [NOT_READY] * 4
    assert [one.is_being_encoded, other.is_being_encoded] == [True, False]
    assert len(workers.futures) == 1
    workers.futures[0].set_result(b"{}")
    await eventually(lambda: bool(ready))
    assert b"{}" in one.frame()
    assert other.frame() is NOT_READY
    assert len(workers.futures) == 2


async def map_as(bench: Bench, **options: Any) -> dict[str, Any]:
    """Return the message of a map of three cells, as a client gets it."""
    cdr = bench.cdr(GRID, info={"width": 3, "height": 1}, data=[-1, 0, 100])
    frame, _ = await received(bench, cdr, GRID, **options)
    message: dict[str, Any] = frame["msg"]
    return message


async def test_a_map_is_a_picture_where_that_is_asked_for(bench: Bench):
    message = await map_as(bench, image={"format": "png"})
    pixels = cv2.imdecode(
        np.frombuffer(base64.b64decode(message["data"]), np.uint8), cv2.IMREAD_UNCHANGED
    )
    assert pixels is not None
    assert pixels.tolist() == [[255, 0, 100]]
    assert (message["format"], message["width"], message["height"]) == ("png", 3, 1)


async def test_a_map_as_a_picture_in_cbor_has_its_bytes(bench: Bench):
    message = await map_as(bench, image={"format": "png"}, compression="cbor")
    assert message["data"].startswith(b"\x89PNG")


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"image": {"format": "raw"}},
        {"image": {"max_fps": 5}},
        {"image": {"format": "png"}, "fields": ["data"]},
    ],
)
async def test_a_map_is_plain_where_no_picture_is_asked_for(bench: Bench, options: dict[str, Any]):
    assert (await map_as(bench, **options))["data"] == [-1, 0, 100]


@pytest.mark.parametrize(
    "image",
    [
        {"format": "jpeg"},
        {"format": "png", "max_width": 8},
        {"format": "png", "max_height": 8},
        {"max_width": 8},
        {"quality": 50},
    ],
)
async def test_a_map_as_a_picture_keeps_its_cells(bench: Bench, image: dict[str, Any]):
    client = bench.listener("/t", GRID, image=image)
    text = 'image: a map comes as png with all of its cells: use only {"format":"png"}'
    assert client.statuses == [("bad_request", text)]
    assert bench.ros.entity_count() == 0
