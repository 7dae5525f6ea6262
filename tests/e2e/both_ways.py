# SPDX-License-Identifier: Apache-2.0
"""Random messages of a type between a robot of plain rclpy and a client, both ways."""

from typing import Any

import pytest
from rclpy.qos import DurabilityPolicy, QoSProfile

from gateway.codec.types import Types
from gateway.sources.rclpy import fast_dds
from schemas.installed import InstalledDefinitions
from tests.client import Client, eventually
from tests.e2e.discovery import until_discovered
from tests.messages import RandomMessages, from_ros, ros_class, to_json, to_ros
from tests.sources.outside import Outside

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


# Its IDL has a key: from Kilted on, readers and writers with and without one do not match.
unless_keyed = pytest.mark.skipif(
    not fast_dds.is_second(), reason="a made type has no key, and this rmw tells types by it"
)


class BothWays:
    """One type, of which the robot has the real package."""

    def __init__(self, name: str, speaker: Client, outside: Outside) -> None:
        self._name = name
        self._last = name.rpartition("/")[2]
        self._speaker = speaker
        self._node = outside.node
        self._definitions = InstalledDefinitions()
        self._definition = self._definitions.get(name)

    async def to_a_client(self, seed: int) -> None:
        plain = RandomMessages(self._definitions, seed).message(self._name)
        topic = f"/out/{self._last}{seed}"
        publisher = self._node.create_publisher(ros_class(self._name), topic, LATCHED)
        publisher.publish(to_ros(self._definition, self._definitions, plain))
        await self._speaker.send(op="subscribe", topic=topic)
        heard = await self._speaker.message(topic)
        # as bytes: a float32 is written as short as it may be
        encode = Types(self._definitions).get(self._name).encode
        assert encode(heard, 0) == encode(to_json(plain), 0)
        assert heard.keys() == plain.keys()
        await self._speaker.send(op="unsubscribe", topic=topic)
        self._node.destroy_publisher(publisher)

    async def to_a_robot(self, seed: int) -> None:
        plain = RandomMessages(self._definitions, seed).message(self._name)
        topic = f"/in/{self._last}{seed}"
        heard: list[Any] = []
        real = ros_class(self._name)
        subscription = self._node.create_subscription(real, topic, heard.append, 10)
        await until_discovered(self._speaker, "subscribers", topic)
        await self._speaker.send(op="publish", topic=topic, type=self._name, msg=to_json(plain))
        assert await self._speaker.sync() == []
        await eventually(lambda: len(heard) == 1)
        assert from_ros(self._definition, self._definitions, heard[0]) == plain
        (publisher,) = self._node.get_publishers_info_by_topic(topic)
        assert publisher.topic_type == self._name
        assert str(publisher.topic_type_hash) == self._definition.type_hash
        await self._speaker.send(op="unadvertise", topic=topic)
        self._node.destroy_subscription(subscription)
