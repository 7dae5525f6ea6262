# SPDX-License-Identifier: Apache-2.0
"""A large latched message, from DDS to real sockets."""

import asyncio
import base64
import json
from typing import Any

import cbor2
from websockets.asyncio.client import connect

from gateway.codec.types import Types
from gateway.config.limits import Limits
from gateway.sources.source import Qos
from schemas.installed import InstalledDefinitions
from tests.client import TIMEOUT_S
from tests.gateway_here import gateway_here
from tests.sources.outside import Outside

GRID = "nav_msgs/msg/OccupancyGrid"
IMAGE = "sensor_msgs/msg/Image"
CELLS = [-1, 0, 100] * 300_000
LATCHED = Qos(durability="transient_local", depth=1)


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
