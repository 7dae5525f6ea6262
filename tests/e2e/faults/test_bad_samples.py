# SPDX-License-Identifier: Apache-2.0
"""Bytes that are not a message, and images that contradict themselves, from a real publisher."""

import asyncio
import base64
import itertools
import json
import random
from collections.abc import AsyncIterator
from typing import Any

import pytest
import pytest_asyncio

from gateway.codec.types import Types
from schemas.installed import InstalledDefinitions
from tests.client import Client, Frame, client, eventually
from tests.e2e.faults.scene import Publisher, publisher
from tests.gateway_process import GatewayProcess, gateway_process

pytestmark = [pytest.mark.asyncio(loop_scope="module"), pytest.mark.timeout(3600)]

STRING, SCAN = "std_msgs/msg/String", "sensor_msgs/msg/LaserScan"
IMAGE, COMPRESSED = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
LITTLE = b"\0\1\0\0"
TEXT = LITTLE + b"\5\0\0\0text\0"
MOST_STATUSES = 30  # of a topic, within the seconds of a test: 16 at once, and one each 5 s

TYPES = Types(InstalledDefinitions())

GOOD: dict[str, dict[str, Any]] = {
    STRING: {"data": "text"},
    SCAN: {"ranges": [1.0, 2.0], "intensities": [3.0]},
    IMAGE: {"width": 4, "height": 2, "encoding": "rgb8", "step": 12, "data": list(range(24))},
    COMPRESSED: {"format": "jpeg", "data": list(range(24))},
}
# the fields of an image, and the text for the client
CONTRADICTIONS: tuple[tuple[dict[str, Any], str], ...] = (
    ({"encoding": "rgb9"}, "unknown image encoding 'rgb9'"),
    ({"encoding": ""}, "unknown image encoding ''"),
    ({"encoding": "x" * 10_000}, "unknown image encoding"),
    ({"width": 0}, "image is 0x2, needs at least 1x1 px"),
    ({"height": 0}, "image is 4x0, needs at least 1x1 px"),
    ({"width": 2**32 - 1, "height": 2**32 - 1}, "at most 8192 px a side"),
    ({"width": 8192, "height": 8192, "step": 24576}, "px in all"),
    ({"step": 11}, "image step is 11, a row of 4 rgb8 pixels has 12 bytes"),
    ({"step": 2**32 - 1}, "image data has 24 bytes"),
    ({"data": []}, "image data has 0 bytes"),
    ({"data": list(range(23))}, "image data has 23 bytes, 2 rows of step 12 have 24"),
    ({"data": list(range(25))}, "image data has 25 bytes"),
    ({"encoding": "nv12", "step": 5, "width": 5}, "3 rows of step 5 have 15"),
    ({"encoding": "bayer_rggb8", "step": 1}, "image step is 1"),
)

_numbers = itertools.count(1)
_reading: set[asyncio.Task[None]] = set()  # until their sockets are closed


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def gateway() -> AsyncIterator[GatewayProcess]:
    async with gateway_process("serve") as gateway:
        yield gateway
        assert gateway.process.returncode is None  # it has survived everything
        assert "Traceback" not in "".join(gateway.log)


@pytest.fixture
def topic() -> str:
    return f"/broken_{next(_numbers)}"


# Malformed CDR

BROKEN = (
    b"\0\1",  # half a header, which DDS fills up
    LITTLE + b"\5\0\0\0te",
    b"\0\2\0\0" + TEXT[4:],  # a parameter list
    b"\0\7\0\0" + TEXT[4:],  # XCDR2
    b"\xde\xad\xbe\xef" + TEXT[4:],
    LITTLE + b"\xff\xff\xff\x7ftext\0",
    LITTLE + b"\xff\xff\xff\xfftext\0",
    LITTLE + b"\0\0\0\5text\0",  # big-endian, said to be little
)
READABLE = {
    b"\0\0\0\0" + b"\0\0\0\5text\0": "text",  # big-endian
    LITTLE + b"\5\0\0\0t\xff\xfet\0": "t\ufffd\ufffdt",  # no UTF-8
    LITTLE + b"\5\0\0\0te\0t\0": "te",
}


async def heard(of: Client, talker: Publisher, topic: str, good: bytes) -> tuple[Any, list[Frame]]:
    """Publish what is good until it comes, and return it, and the statuses that came before."""
    of.seen.clear()
    await talker.repeat(good)
    message = await of.message(topic)
    return message, [frame for frame in of.seen if frame["op"] == "status"]


def read(of: Client) -> list[Frame]:
    """Read what comes for a client that only watches. The gateway closes those that do not."""
    frames: list[Frame] = []

    async def follow() -> None:
        async for text in of.socket:
            frame = json.loads(text) if isinstance(text, str) else {"op": "binary"}
            frames.append(frame)

    _reading.add(task := asyncio.create_task(follow()))
    task.add_done_callback(_reading.discard)
    return frames


async def told_of(of: Client, talker: Publisher, topic: str, cdr: bytes) -> Frame:
    """Publish what is broken, and return the status that says so."""
    await talker.publish(cdr)
    status = await of.status()
    assert (status["level"], status["code"]) == ("warning", "invalid_value")
    assert status["msg"].startswith(f"{topic}: ")
    assert len(status["msg"]) < 300
    return status


async def test_invalid_samples_are_reported_and_the_next_ones_come(
    gateway: GatewayProcess, topic: str
):
    async with (
        client(gateway.url) as listener,
        client(gateway.url) as bystander,
        publisher(topic, STRING) as talker,
        publisher("/well", STRING) as other,
    ):
        await bystander.send(op="subscribe", topic="/well", type=STRING)
        await heard(bystander, other, "/well", TEXT)
        frames = read(bystander)
        await listener.send(op="subscribe", topic=topic, type=STRING)
        for broken in BROKEN:
            message, _ = await heard(listener, talker, topic, TEXT)
            assert message == {"data": "text"}
            await told_of(listener, talker, topic, broken)
        before = len(frames)
        await eventually(lambda: len(frames) > before)
        assert {frame["op"] for frame in frames} == {"publish"}


async def test_readable_messages_are_still_read(gateway: GatewayProcess, topic: str):
    async with client(gateway.url) as listener, publisher(topic, STRING) as talker:
        await listener.send(op="subscribe", topic=topic, type=STRING)
        for cdr, text in READABLE.items():
            message = None
            while message != {"data": text}:
                message, statuses = await heard(listener, talker, topic, cdr)
                assert statuses == []


@pytest.mark.parametrize(
    ("type_name", "compression"),
    [(STRING, "none"), (SCAN, "cbor"), (SCAN, "png"), (IMAGE, "none"), (COMPRESSED, "cbor")],
)
async def test_a_flood_of_nonsense_is_told_of_in_few_words(
    gateway: GatewayProcess, topic: str, type_name: str, compression: str
):
    chance = random.Random(topic)
    good = TYPES.get(type_name).encode(GOOD[type_name], now_ns=0)
    async with client(gateway.url) as listener, publisher(topic, type_name) as talker:
        frames = read(listener)
        await listener.send(op="subscribe", topic=topic, type=type_name, compression=compression)
        await talker.repeat(good)
        await eventually(lambda: bool(frames))
        for _ in range(300):
            damaged = bytearray(good)
            for _ in range(chance.randrange(1, 8)):
                damaged[chance.randrange(len(damaged))] = chance.choice((0, 1, 0x7F, 0xFF))
            await talker.publish(bytes(damaged[: chance.randrange(len(damaged))]))
        await talker.repeat(good)
        told = [frame for frame in frames if frame["op"] == "status"]
        before = len(frames) - len(told)
        await eventually(lambda: len([f for f in frames if f["op"] != "status"]) > before)
        assert 0 < len([f for f in frames if f["op"] == "status"]) < MOST_STATUSES


# Pictures


def picture(**fields: Any) -> bytes:
    values = GOOD[IMAGE] | fields
    return TYPES.get(IMAGE).encode(values, now_ns=0)


@pytest.mark.parametrize("format_", ["jpeg", "png"])
async def test_pictures_that_contradict_themselves_are_told_of_and_the_next_ones_come(
    gateway: GatewayProcess, topic: str, format_: str
):
    async with (
        client(gateway.url) as listener,
        client(gateway.url) as raw,
        publisher(topic, IMAGE) as talker,
    ):
        options = {"format": format_}
        await listener.send(op="subscribe", topic=topic, type=IMAGE, image=options)
        await raw.send(op="subscribe", topic=topic, type=IMAGE, image={"format": "raw"})
        frames = read(raw)
        for fields, words in CONTRADICTIONS:
            message, _ = await heard(listener, talker, topic, picture())
            assert (message["format"], message["width"]) == (format_, 4)
            status = await told_of(listener, talker, topic, picture(**fields))
            assert words in status["msg"]
        # pixels as they are contradict nothing that the gateway would have to know
        assert {frame["op"] for frame in frames} == {"publish"}


async def test_pictures_compressed_by_others_pass_unread(gateway: GatewayProcess, topic: str):
    whole = b"\xff\xd8\xff\xe0" + bytes(range(256))
    async with client(gateway.url) as listener, publisher(topic, COMPRESSED) as talker:
        await listener.send(op="subscribe", topic=topic, type=COMPRESSED)
        for format_, data in (
            ("jpeg", whole[:20]),
            ("png", whole),
            ("no such format", whole),
            ("", b""),
        ):
            values = {"format": format_, "data": list(data)}
            cdr = TYPES.get(COMPRESSED).encode(values, now_ns=0)
            message = None
            while message is None or message["format"] != format_:
                message, statuses = await heard(listener, talker, topic, cdr)
                assert statuses == []
            assert base64.b64decode(message["data"]) == data
