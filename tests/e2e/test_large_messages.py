# SPDX-License-Identifier: Apache-2.0
"""A large latched message, from DDS to real sockets."""

import asyncio
import base64
import json
from collections.abc import Iterator
from typing import Any

import cbor2
import pytest
from websockets.asyncio.client import connect

from gateway.codec.json_slices import json_slices
from gateway.codec.types import Types
from gateway.config.limits import Limits
from gateway.core.topics import encoding as encoding_module
from gateway.core.topics import slices
from gateway.sources.source import Qos
from schemas.installed import InstalledDefinitions
from tests.client import TIMEOUT_S, client
from tests.gateway_here import gateway_here
from tests.sources.outside import Outside

GRID = "nav_msgs/msg/OccupancyGrid"
IMAGE = "sensor_msgs/msg/Image"
CELLS = [-1, 0, 100] * 300_000
LATCHED = Qos(durability="transient_local", depth=1)


@pytest.fixture
def outside() -> Iterator[Outside]:
    outside = Outside()
    yield outside
    outside.close()


async def test_a_late_client_gets_the_same_map_without_another_encoding(
    outside: Outside, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(slices, "TURN_NS", 0)  # so that the loop has a turn after each step
    encoded: list[Any] = []

    def counting(value: Any, write: Any) -> Iterator[bytes]:
        encoded.append(value)
        return json_slices(value, write)

    monkeypatch.setattr(encoding_module, "json_slices", counting)
    types = Types(InstalledDefinitions())
    publisher = outside.add_publisher("/map", GRID, LATCHED)
    publisher.publish(types.get(GRID).encode({"data": CELLS}, now_ns=0))
    async with gateway_here(Limits()) as url, client(url) as early:
        await early.send(op="subscribe", topic="/map", type=GRID)
        assert (await early.message("/map"))["data"] == CELLS
        for meta in (False, True):
            async with client(url) as late:
                await late.send(op="subscribe", topic="/map", type=GRID, meta=meta)
                assert (await late.message("/map"))["data"] == CELLS
    assert len(encoded) == 1


async def test_a_second_listener_on_a_connection_also_gets_the_map(outside: Outside):
    types = Types(InstalledDefinitions())
    publisher = outside.add_publisher("/map", GRID, LATCHED)
    publisher.publish(types.get(GRID).encode({"data": CELLS[:9]}, now_ns=0))
    async with gateway_here(Limits()) as url, client(url) as page:
        for request_id in ("a", "b", "c"):
            await page.send(op="subscribe", id=request_id, topic="/map", type=GRID)
            assert (await page.message("/map"))["data"] == CELLS[:9]


async def test_a_map_as_a_picture_is_far_smaller(outside: Outside):
    types = Types(InstalledDefinitions())
    publisher = outside.add_publisher("/map", GRID, LATCHED)
    info = {"width": 1000, "height": 900}
    cells = sorted(CELLS)  # few edges, as in a building
    publisher.publish(types.get(GRID).encode({"info": info, "data": cells}, now_ns=0))
    async with gateway_here(Limits()) as url, client(url) as viewer:
        await viewer.send(op="subscribe", topic="/map", type=GRID, image={"format": "png"})
        message = await viewer.message("/map")
    assert (message["width"], message["height"], message["info"]["width"]) == (1000, 900, 1000)
    assert len(message["data"]) < len(cells) // 10


async def test_a_large_picture_comes_in_each_form(outside: Outside):
    types = Types(InstalledDefinitions())
    pixels = bytes(range(256)) * (640 * 480 * 3 // 256)
    values = {"width": 640, "height": 480, "encoding": "rgb8", "step": 1920}
    cdr = types.get(IMAGE).encode({**values, "data": base64.b64encode(pixels).decode()}, now_ns=0)
    outside.add_publisher("/camera", IMAGE, LATCHED).publish(cdr)
    async with gateway_here(Limits()) as url:
        frames = [
            await first_frame(url, **options)
            for options in (
                {"image": {"format": "jpeg"}},
                {"image": {"format": "raw"}},
                {"compression": "png"},
                {"compression": "cbor", "image": {"format": "raw"}},
                {"compression": "cbor-raw"},
            )
        ]
    jpeg, raw, png, cbor, cbor_raw = frames
    assert jpeg["msg"]["format"] == "jpeg"
    assert jpeg["msg"]["width"] == 640
    assert raw["msg"]["data"] == base64.b64encode(pixels).decode()
    assert png["op"] == "png"
    assert cbor["msg"]["data"] == pixels
    assert cbor_raw["msg"]["bytes"] == cdr


async def first_frame(url: str, **options: Any) -> dict[str, Any]:
    async with connect(url, max_size=None, compression=None, proxy=None) as socket:
        await socket.send(
            json.dumps({"op": "subscribe", "topic": "/camera", "type": IMAGE, **options})
        )
        async with asyncio.timeout(TIMEOUT_S):
            frame = await socket.recv()
    found: dict[str, Any] = cbor2.loads(frame) if isinstance(frame, bytes) else json.loads(frame)
    return found
