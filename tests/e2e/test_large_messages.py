# SPDX-License-Identifier: Apache-2.0
"""A large latched message, from DDS to real sockets."""

from collections.abc import Iterator
from typing import Any

import pytest

from gateway.codec.json_slices import json_slices
from gateway.codec.types import Types
from gateway.config.limits import Limits
from gateway.ports import Qos
from gateway.router.topics import encoding as encoding_module
from gateway.router.topics import slices
from schemas.installed import InstalledDefinitions
from tests.client import client
from tests.gateway_here import gateway_here
from tests.ros.outside import Outside

GRID = "nav_msgs/msg/OccupancyGrid"
CELLS = [-1, 0, 100] * 300_000
LATCHED = Qos(durability="transient_local", depth=1)


@pytest.fixture
def outside() -> Iterator[Outside]:
    outside = Outside()
    yield outside
    outside.close()


async def test_who_comes_late_gets_the_same_map_without_another_encoding(
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
