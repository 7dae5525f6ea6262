# SPDX-License-Identifier: Apache-2.0
"""Infinities between Python's json and rclpy, both ways, as REP 117 uses them."""

import asyncio
import json
import math
from collections.abc import AsyncIterator, Iterator

import pytest
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import LaserScan

from gateway.config.limits import Limits
from gateway.sources.source import Sample
from tests.client import Client, client, eventually
from tests.gateway_here import gateway_here
from tests.sources.outside import Outside

SCAN = "sensor_msgs/msg/LaserScan"
RANGES = [0.5, math.inf, -math.inf, math.nan]


@pytest.fixture
def outside() -> Iterator[Outside]:
    outside = Outside()
    yield outside
    outside.close()


@pytest.fixture
async def url() -> AsyncIterator[str]:
    async with gateway_here(Limits()) as url:
        yield url


def same(ranges: list[float]) -> bool:
    return list(map(str, ranges)) == list(map(str, RANGES))


async def publish_until(talker: Client, scan: object, arrived: list[Sample]) -> LaserScan:
    """Publish as roslibpy does, by json.dumps, until ROS has it."""
    arrived.clear()
    while not arrived:
        await talker.send(op="publish", topic="/numbers/in", type=SCAN, msg=scan)
        await asyncio.sleep(0.05)
    return deserialize_message(arrived[-1].cdr, LaserScan)


async def test_infinities_survive_the_way_from_and_to_ros(url: str, outside: Outside):
    arrived: list[Sample] = []
    outside.add_subscription("/numbers/in", SCAN, arrived.extend)
    publisher = outside.add_publisher("/numbers/out", SCAN)
    cdr = serialize_message(LaserScan(range_max=math.inf, ranges=RANGES))
    async with client(url) as talker:
        assert "Infinity" in json.dumps(RANGES)
        scan = await publish_until(talker, {"range_max": math.inf, "ranges": RANGES}, arrived)
        assert scan.range_max == math.inf
        assert same(scan.ranges)

        await talker.send(op="subscribe", topic="/numbers/out", type=SCAN, nonfinite="string")
        await eventually(lambda: outside.node.count_subscribers("/numbers/out") > 0)
        message = asyncio.create_task(talker.message("/numbers/out"))
        while not message.done():
            publisher.publish(cdr)
            await asyncio.wait([message], timeout=0.1)
        got = message.result()
        assert got["ranges"] == [0.5, "Infinity", "-Infinity", "NaN"]
        scan = await publish_until(talker, got, arrived)
        assert scan.range_max == math.inf
        assert same(scan.ranges)
