# SPDX-License-Identifier: Apache-2.0
"""The list of message types row by row, in both directions, through real DDS and a gateway process.

The other side is plain rclpy in this process: its own messages, its own serialisation.
"""

from collections.abc import AsyncIterator, Iterator
from typing import Any

import pytest
import pytest_asyncio
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import deserialize_message

from gateway.codec.types import Types
from schemas.installed import InstalledDefinitions
from schemas.table import Row, Table
from tests.client import Client, client, eventually
from tests.e2e.discovery import until_discovered
from tests.gateway_process import ALL_TIME, gateway_process
from tests.messages import Plain, RandomMessages, from_ros, ros_class, to_json, to_ros
from tests.sources.outside import Outside

ROWS = Table.load().rows
DEFINITIONS = InstalledDefinitions()
TYPES = Types(DEFINITIONS)
MESSAGES = RandomMessages(DEFINITIONS, seed=7)
UNLIMITED = (
    *("--set", "limits.max_subscriptions=500"),
    *("--set", "limits.max_advertisements=500"),
    *("--set", "limits.max_ros_entities=1000"),
    *ALL_TIME,
)
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)

pytestmark = [pytest.mark.brief, pytest.mark.asyncio(loop_scope="module")]


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def speaker() -> AsyncIterator[Client]:
    async with gateway_process("serve", *UNLIMITED) as gateway, client(gateway.url) as speaker:
        yield speaker


@pytest.fixture(scope="module")
def outside() -> Iterator[Outside]:
    outside = Outside("robot")
    yield outside
    outside.close()


def by_rclpy(name: str, message: Any) -> Plain:
    """Return what rclpy makes of a JSON message, so that no decoder of ours vouches for us."""
    message_type = TYPES.get(name)
    cdr = message_type.encode(message, now_ns=0)
    definition = message_type.definition
    return from_ros(definition, DEFINITIONS, deserialize_message(cdr, ros_class(name)))


def row_id(row: Row) -> str:
    return f"{row.number}-{row.name}"


@pytest.mark.parametrize("row", ROWS, ids=row_id)
async def test_messages_of_a_robot_reach_a_client(row: Row, speaker: Client, outside: Outside):
    plain = MESSAGES.message(row.name)
    publisher = outside.node.create_publisher(ros_class(row.name), f"/out/t{row.number}", LATCHED)
    publisher.publish(to_ros(DEFINITIONS.get(row.name), DEFINITIONS, plain))
    topic = f"/out/t{row.number}"
    await speaker.send(op="subscribe", topic=topic, image={"format": "raw"})
    assert by_rclpy(row.name, await speaker.message(topic)) == plain
    await speaker.send(op="unsubscribe", topic=topic)
    outside.node.destroy_publisher(publisher)


@pytest.mark.parametrize("row", ROWS, ids=row_id)
async def test_messages_of_a_client_reach_a_robot(row: Row, speaker: Client, outside: Outside):
    plain = MESSAGES.message(row.name)
    heard: list[Any] = []
    topic = f"/in/t{row.number}"
    subscription = outside.node.create_subscription(ros_class(row.name), topic, heard.append, 10)
    # ROS loses what is published before the subscription is discovered
    await until_discovered(speaker, "subscribers", topic)
    await speaker.send(op="publish", topic=topic, type=row.number, msg=to_json(plain))
    assert await speaker.sync() == []
    await eventually(lambda: len(heard) == 1)
    assert from_ros(DEFINITIONS.get(row.name), DEFINITIONS, heard[0]) == plain
    await speaker.send(op="unadvertise", topic=topic)
    outside.node.destroy_subscription(subscription)
