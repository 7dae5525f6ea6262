# SPDX-License-Identifier: Apache-2.0
"""Pictures that clients publish, and the pixels that ROS gets of them."""

import base64
import threading
from collections.abc import Iterator, Sequence
from typing import Any

import cbor2
import cv2
import numpy as np
import pytest

from gateway.codec.grid_picture import GRID
from gateway.codec.picture import pixel_maker
from gateway.core.topics import published_pictures
from gateway.sources.source import Sample
from tests.client import eventually
from tests.core.conftest import IMAGE, LIMITS, TWIST, Bench, Socketless

TOPIC = "/screen"
COLOURS = np.random.default_rng(1).integers(0, 256, (6, 8, 3), np.uint8)


def coded(pixels: np.ndarray, extension: str = ".png") -> bytes:
    done, data = cv2.imencode(extension, pixels)
    assert done
    return data.tobytes()


def message(pixels: np.ndarray = COLOURS, **more: Any) -> dict[str, Any]:
    return {"format": "png", "data": base64.b64encode(coded(pixels)).decode(), **more}


def listen(bench: Bench, topic: str = TOPIC) -> list[dict[str, Any]]:
    heard: list[dict[str, Any]] = []
    decode = bench.types.get(IMAGE).decoder(octets="raw")

    def note(samples: Sequence[Sample]) -> None:
        heard.extend(decode(sample.cdr) for sample in samples)

    bench.ros.add_subscription(topic, IMAGE, note)
    return heard


def advertising(bench: Bench, topic: str = TOPIC) -> Socketless:
    return bench.sender(op="advertise", topic=topic, type=IMAGE, image={"format": "png"})


def publish(client: Socketless, msg: object, topic: str = TOPIC, **more: object) -> None:
    client.send(op="publish", topic=topic, msg=msg, **more)


class PausedDecoding:
    """Pictures that wait in their worker until they may go on."""

    def __init__(self) -> None:
        self.begun: list[str] = []  # their formats
        self.done: list[str] = []
        self._may_go_on = threading.Semaphore(0)

    def release(self, count: int = 1) -> None:
        self._may_go_on.release(count)

    def make(self, *types: Any) -> Any:
        decode = pixel_maker(*types)
        format_of = types[0].decoder(("format",))

        def wait(cdr: bytes) -> bytes:
            name = format_of(cdr)["format"]
            self.begun.append(name)
            assert self._may_go_on.acquire(timeout=60)
            try:
                return decode(cdr)
            finally:
                self.done.append(name)

        return wait


@pytest.fixture
def paused(monkeypatch: pytest.MonkeyPatch) -> Iterator[PausedDecoding]:
    paused = PausedDecoding()
    monkeypatch.setattr(published_pictures, "pixel_maker", paused.make)
    yield paused
    paused.release(100)


@pytest.mark.parametrize(
    ("pixels", "encoding"),
    [
        (COLOURS, "bgr8"),
        (COLOURS[:, :, 0], "mono8"),
        (COLOURS[:, :, 0].astype(np.uint16) * 257, "mono16"),
        (np.dstack((COLOURS, COLOURS[:, :, 0])), "bgra8"),
    ],
)
async def test_ros_gets_the_pixels_of_a_png(bench: Bench, pixels, encoding):
    heard, client = listen(bench), advertising(bench)
    header = {"stamp": {"sec": 7, "nanosec": 8}, "frame_id": "eye"}
    publish(client, message(np.ascontiguousarray(pixels), header=header))
    await eventually(lambda: len(heard) == 1)
    (image,) = heard
    assert image["header"] == header
    assert (image["height"], image["width"], image["encoding"]) == (6, 8, encoding)
    assert (image["is_bigendian"], image["step"]) == (0, pixels.nbytes // 6)
    assert bytes(image["data"]) == pixels.tobytes()
    assert client.frames == []


async def test_a_jpeg_in_cbor_needs_no_base64_and_is_stamped_now(bench: Bench):
    heard, client = listen(bench), advertising(bench)
    smooth = np.full((6, 8, 3), (10, 100, 200), np.uint8)
    msg = {"header": {}, "format": "jpeg", "data": coded(smooth, ".jpg")}
    client.send_raw(cbor2.dumps({"op": "publish", "topic": TOPIC, "msg": msg}))
    await eventually(lambda: len(heard) == 1)
    pixels = np.frombuffer(heard[0]["data"], np.uint8).reshape(6, 8, 3)
    assert np.abs(pixels.astype(int) - smooth).max() <= 3
    assert heard[0]["header"]["stamp"]["sec"] == 1_700_000_000


async def test_pictures_of_the_gateway_can_be_sent_back(bench: Bench):
    heard, client = listen(bench), advertising(bench)
    client.send(op="subscribe", topic="/camera", type=IMAGE, image={"format": "png"})
    camera = bench.ros.add_publisher("/camera", IMAGE)
    fields = {"height": 6, "width": 8, "encoding": "bgr8", "step": 24}
    camera.publish(bench.cdr(IMAGE, **fields, data=base64.b64encode(COLOURS.tobytes()).decode()))
    (picture,) = await client.sees(1)
    publish(client, picture["msg"])
    await eventually(lambda: len(heard) == 1)
    assert bytes(heard[0]["data"]) == COLOURS.tobytes()


@pytest.mark.parametrize(
    ("msg", "words"),
    [
        ({"data": "AAAA"}, "msg.data: data is neither JPEG nor PNG"),
        (message(np.zeros((4096, 3072, 3), np.uint8)), "has 37748736 bytes of pixels, at most"),
        ({"data": "?"}, "msg.data: text is not valid base64"),
        ({"data": "", "encoding": "rgb8"}, "msg.encoding: unknown field of sensor_msgs/msg/Comp"),
        (5, "msg: expected an object, got 5"),
    ],
)
async def test_an_invalid_picture_is_refused_with_the_reason(bench: Bench, msg, words):
    heard, client = listen(bench), advertising(bench)
    publish(client, msg, id="p")
    await client.sees(1, "status")
    (status,) = client.of("status")
    assert (status["code"], status["id"], status["request"]) == ("invalid_value", "p", "publish")
    assert words in status["msg"]
    publish(client, message())
    await eventually(lambda: len(heard) == 1)


async def test_only_images_are_made_of_pictures(bench: Bench):
    client = bench.sender(op="advertise", topic="/cmd_vel", type=TWIST, image={"format": "jpeg"})
    assert client.statuses == [
        ("bad_request", f"image: {TWIST} is not an image type, use {IMAGE} or {GRID}")
    ]
    client = bench.client()
    client.send(op="advertise", topic="/a", type="std_msgs/String", image={"format": "jpeg"})
    client.send(op="advertise", topic="/b", type=IMAGE, image={"format": "gif"})
    client.send(op="advertise", topic="/b", type=IMAGE, image={})
    of_string, gif, missing = client.statuses
    text = f"image: std_msgs/msg/String is not an image type, use {IMAGE} or {GRID}"
    assert of_string == ("bad_request", text)
    assert gif[0] == "bad_request"
    assert gif[1].startswith("image.format: expected 'jpeg', ")
    assert missing == ("bad_request", "image.format: missing")
    assert bench.ros.publishers == []


async def test_an_advertisement_takes_one_or_the_other(bench: Bench):
    client = advertising(bench)
    client.send(op="advertise", topic=TOPIC, type=IMAGE)
    assert client.statuses == [("type_conflict", f"topic {TOPIC} is advertised for images")]
    heard = listen(bench, "/raw")
    client.send(op="advertise", topic="/raw", type=IMAGE, image={"format": "raw"})
    client.send(op="advertise", topic="/raw", type=IMAGE)
    publish(client, {"width": 3}, "/raw")
    await eventually(lambda: len(heard) == 1)
    client.send(op="advertise", topic="/raw", type=IMAGE, image={"format": "jpeg"})
    assert client.statuses[1:] == [("type_conflict", "topic /raw is advertised for plain messages")]


def named(name: str) -> dict[str, Any]:
    return message() | {"format": name}


async def test_while_one_is_decoded_the_newest_waits(bench: Bench, paused: PausedDecoding):
    heard, client = listen(bench), advertising(bench)
    publish(client, named("0"))
    await eventually(lambda: paused.begun == ["0"])
    for number in range(1, 5):
        publish(client, named(str(number)))
    assert client.session.replaced == 3
    paused.release(2)
    await eventually(lambda: len(heard) == 2)
    assert paused.begun == ["0", "4"]


async def test_clients_take_turns_and_one_worker_is_left_for_others(
    bench: Bench, paused: PausedDecoding
):
    first, second = advertising(bench), advertising(bench, "/other")
    first.send(op="advertise", topic="/third", type=IMAGE, image={"format": "png"})
    publish(first, named("first"))
    await eventually(lambda: paused.begun == ["first"])
    publish(first, named("again"))
    publish(first, named("third"), "/third")
    publish(second, named("second"), "/other")
    await bench.settle()
    assert paused.begun == ["first"]
    for count in range(1, 4):
        paused.release()
        await eventually(lambda count=count: len(paused.begun) == count + 1)
    assert paused.begun == ["first", "second", "again", "third"]


async def test_waiting_pictures_of_a_client_fit_in_one_message(
    bench: Bench, paused: PausedDecoding
):
    client = advertising(bench)
    publish(client, named("first"))
    await eventually(lambda: paused.begun == ["first"])
    half = LIMITS.max_message_bytes // 2
    long = {"format": "long", "data": base64.b64encode(bytes(half)).decode()}
    for topic in ("/a", "/b"):
        client.send(op="advertise", topic=topic, type=IMAGE, image={"format": "png"})
        publish(client, long, topic)
    waiting = bench.router._publications._pictures._waiting[client.session]
    assert client.statuses == []
    assert list(waiting) == ["/b"]
    assert waiting["/b"].request.msg is None  # nor is it kept twice
    assert client.session.replaced == 1


@pytest.mark.parametrize("ends", ["unadvertise", "leave"])
async def test_pictures_that_are_ready_too_late_are_not_published(
    bench: Bench, paused: PausedDecoding, ends: str
):
    heard, client = listen(bench), advertising(bench)
    publish(client, named("late"))
    await eventually(lambda: paused.begun == ["late"])
    publish(client, named("waits"))
    if ends == "leave":
        bench.router.leave(client.session)
    else:
        client.send(op="unadvertise", topic=TOPIC)
    paused.release(2)
    await eventually(lambda: paused.done == ["late"])
    other, others = advertising(bench, "/other"), listen(bench, "/other")
    paused.release()
    publish(other, named("other"), "/other")  # has its turn when nothing of the first waits
    await eventually(lambda: len(others) == 1)
    assert paused.begun == ["late", "other"]
    assert (heard, client.frames) == ([], [])
