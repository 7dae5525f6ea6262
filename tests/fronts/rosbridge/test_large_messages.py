# SPDX-License-Identifier: Apache-2.0
"""Messages that take long to read: maps by every way in, and others are served between."""

import base64
import gc
import json
from collections import deque
from collections.abc import Callable, Sequence
from typing import Any

import cbor2
import cv2
import numpy as np
import pytest

from gateway.sources.source import RosError, Sample
from tests.client import eventually
from tests.core.conftest import GRID, Bench, Socketless

SIZES = [(604, 307), (400, 400), (1006, 1674)]  # of the maps of Nav2
Way = Callable[[Socketless, int, int, bytes], None]


def cells(width: int, height: int) -> bytes:
    return np.random.default_rng(width).choice([-1, 0, 100], width * height).astype("i1").tobytes()


def listen(bench: Bench) -> list[dict[str, Any]]:
    heard: list[dict[str, Any]] = []
    decode = bench.types.get(GRID).decoder(octets="raw")

    def note(samples: Sequence[Sample]) -> None:
        heard.extend(decode(sample.cdr) for sample in samples)

    bench.ros.add_subscription("/map", GRID, note)
    return heard


def info(width: int, height: int) -> dict[str, Any]:
    return {"width": width, "height": height, "resolution": 0.05, "origin": {"position": {"x": 2}}}


def operation(width: int, height: int, data: object) -> dict[str, Any]:
    msg = {"info": info(width, height), "data": data}
    return {"op": "publish", "topic": "/map", "type": GRID, "msg": msg}


def numbers(data: bytes) -> list[int]:
    values: list[int] = np.frombuffer(data, np.int8).tolist()
    return values


def as_json(client: Socketless, width: int, height: int, data: bytes) -> None:
    client.send(**operation(width, height, numbers(data)))


def in_fragments(client: Socketless, width: int, height: int, data: bytes) -> None:
    text = json.dumps(operation(width, height, numbers(data)))
    pieces = [text[start : start + 100_000] for start in range(0, len(text), 100_000)]
    for number, piece in enumerate(pieces):
        client.send(op="fragment", id="map", data=piece, num=number, total=len(pieces))


def as_base64(client: Socketless, width: int, height: int, data: bytes) -> None:
    client.send(**operation(width, height, base64.b64encode(data).decode()))


def as_typed_array(client: Socketless, width: int, height: int, data: bytes) -> None:
    typed = cbor2.CBORTag(72, data)
    client.send_raw(cbor2.dumps(operation(width, height, typed)))


def as_bytes(client: Socketless, width: int, height: int, data: bytes) -> None:
    client.send_raw(cbor2.dumps(operation(width, height, data)))


def as_png(client: Socketless, width: int, height: int, data: bytes) -> None:
    client.send(op="advertise", topic="/map", type=GRID, image={"format": "png"})
    done, png = cv2.imencode(".png", np.frombuffer(data, np.uint8).reshape(height, width))
    assert done
    client.send(**operation(width, height, base64.b64encode(png.tobytes()).decode()))


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize(
    "publish", [as_json, in_fragments, as_base64, as_typed_array, as_bytes, as_png]
)
async def test_a_map_of_nav2_reaches_ros(bench: Bench, publish: Way, size):
    heard = listen(bench)
    client = bench.client()
    publish(client, *size, cells(*size))
    await eventually(lambda: len(heard) == 1)
    (found,) = heard
    assert np.asarray(found["data"]).tobytes() == cells(*size)
    assert (found["info"]["width"], found["info"]["height"]) == size
    assert found["info"]["origin"]["position"]["x"] == 2
    assert client.frames == []


@pytest.mark.parametrize(
    ("png", "more", "words"),
    [
        (np.zeros((2, 3), np.uint8), {"width": 4}, "3 x 2 pixels, info says 4 x 0"),
        (np.zeros((2, 3, 3), np.uint8), {}, "grey of 8 bits"),
        (None, {}, "neither JPEG nor PNG"),
    ],
)
async def test_a_png_without_a_map_is_refused(bench: Bench, png, more, words):
    client = bench.sender(op="advertise", topic="/map", type=GRID, image={"format": "png"})
    data = b"no png" if png is None else cv2.imencode(".png", png)[1].tobytes()
    msg = {"format": "png", "info": more, "data": base64.b64encode(data).decode()}
    client.send(op="publish", topic="/map", msg=msg)
    (status,) = await client.sees(1, "status")
    assert words in status["msg"]


class Turns:
    """The remaining work of the clients, which the test does one after the other."""

    def __init__(self) -> None:
        self.left: deque[Callable[[], None]] = deque()
        self.unreadable: list[bytes] = []

    def client(self, bench: Bench) -> Socketless:
        client = bench.client(on_unreadable=self.unreadable.append)
        client.turns.next_turn = self.left.append
        return client

    def finish(self) -> None:
        while self.left:
            self.left.popleft()()


async def test_others_are_served_while_a_long_message_is_read(bench: Bench):
    heard = listen(bench)
    turns = Turns()
    client, other = turns.client(bench), bench.client()
    as_json(client, 1006, 1674, cells(1006, 1674))
    while turns.left:
        turns.left.popleft()()
        other.send(op="ping")
    await eventually(lambda: len(heard) == 1)
    assert len(other.of("pong")) > 3


async def test_one_long_message_is_read_at_a_time_and_none_waits_for_a_client_that_is_gone(
    bench: Bench,
):
    heard = listen(bench)
    turns, of_second = Turns(), Turns()
    first, second = turns.client(bench), of_second.client(bench)
    as_json(first, 1006, 1674, cells(1006, 1674))
    as_json(second, 400, 400, cells(400, 400))
    for _ in range(1000):
        of_second.left.popleft()()
    assert len(of_second.left) == 1
    assert heard == []
    turns.left.clear()  # as the connection does when it is lost
    gc.collect()
    of_second.finish()
    await eventually(lambda: len(heard) == 1)
    assert heard[0]["info"]["width"] == 400


async def test_a_long_text_that_is_refused_is_answered_once(bench: Bench):
    turns = Turns()
    client = turns.client(bench)
    numbers = b"1," * 60_000  # and none behind the last comma
    client.send_raw(b'{"op":"publish","id":"p","topic":"/t","msg":{"data":[' + numbers + b"]}}")
    turns.finish()
    (status,) = client.of("status")
    assert "not JSON" in status["msg"]
    assert len(turns.unreadable) == 1


async def test_encoding_a_large_message_and_handing_it_over_take_a_turn_each(bench: Bench):
    heard = listen(bench)
    turns = Turns()
    client = turns.client(bench)
    as_bytes(client, 1006, 1674, cells(1006, 1674))
    turns.left.popleft()()
    assert len(turns.left) == 1
    turns.finish()
    await eventually(lambda: len(heard) == 1)
    as_bytes(client, 400, 400, cells(400, 400))
    turns.left.popleft()()
    assert not turns.left


async def test_a_large_message_of_who_is_behind_goes_out_before_its_topic_is_withdrawn(
    bench: Bench,
):
    heard = listen(bench)
    turns = Turns()
    client = turns.client(bench)
    client.send(op="advertise", topic="/map", type=GRID, queue_size=1)
    client.turns.is_behind = True
    as_bytes(client, 1006, 1674, cells(1006, 1674))
    turns.finish()
    client.send(op="unadvertise", topic="/map")
    turns.finish()
    await eventually(lambda: len(heard) == 1)


async def test_a_large_message_that_ros_refuses_is_answered(bench: Bench, monkeypatch):
    client = bench.sender(op="advertise", topic="/map", type=GRID)
    (publisher,) = bench.ros.publishers

    def refuse(cdr: bytes) -> None:
        raise RosError("internal", f"{len(cdr)} bytes are too many")

    monkeypatch.setattr(publisher, "publish", refuse)
    as_json(client, 1006, 1674, cells(1006, 1674))
    (status,) = client.of("status")
    assert (status["code"], status["request"]) == ("internal", "publish")
