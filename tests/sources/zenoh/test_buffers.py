# SPDX-License-Identifier: Apache-2.0
"""Publishers of Lyrical with buffers, as the source of rmw_zenoh 0.10.5 has them. None was run.

They publish in the plain way only if a subscription names no backend, and then to all in that way.
"""

import itertools
import time
from typing import Any

from tests.client import eventually
from tests.sources.zenoh.conftest import open_robot
from tests.sources.zenoh.outside import DOMAIN, gid_of, hash_of
from tests.sources.zenoh.test_session import subscribe
from tests.sources.zenoh.world import ATTACHMENT, ZenohWorld, dds

IMAGE = "sensor_msgs/msg/CompressedImage"


class BufferPublisher:
    """A publisher that looks at the tokens of subscriptions before it publishes."""

    def __init__(self, world: ZenohWorld, topic: str) -> None:
        of_type = f"{dds(IMAGE)}/{hash_of(IMAGE)}"
        self._key, session = f"{DOMAIN}{topic}/{of_type}", world.session
        escaped = topic.replace("/", "%")
        token = f"{world.token('MP')}/{escaped}/{of_type}/::,10:,:,:,,/backends:cpu:;cuda:0"
        self._gid, self._numbers = gid_of(token), itertools.count(1)
        self.subscriptions: set[str] = set()
        self.plain = 0  # how often it has published in the plain way
        self._session = session
        live = session.liveliness()
        self._watch = live.declare_subscriber(
            f"@ros2_lv/{DOMAIN}/*/*/*/MS/*/*/*/{escaped}/**", self._change, history=True
        )
        self._token = live.declare_token(token)

    def _change(self, sample: Any) -> None:
        change = self.subscriptions.add if "PUT" in str(sample.kind) else self.subscriptions.discard
        change(str(sample.key_expr))

    def publish(self, cdr: bytes) -> None:
        is_plain = any("/backends:" not in each for each in self.subscriptions)
        self.plain += is_plain
        attachment = ATTACHMENT.pack(next(self._numbers), time.time_ns(), 16, self._gid)
        key = self._key if is_plain else f"{self._key}/_buf_cpu"
        self._session.put(key, cdr, attachment=attachment)

    def close(self) -> None:
        self._watch.undeclare()
        self._token.undeclare()


async def test_a_subscription_leaves_their_buffers_to_publishers_of_lyrical():
    with open_robot() as (source, world):
        before = subscribe(source, "/image", IMAGE)  # it comes before the publisher
        publisher = BufferPublisher(world, "/image")
        await eventually(lambda: [each.has_buffers for each in ends(source)] == [True])

        def arrives() -> bool:
            publisher.publish(b"picture")
            return bool(before.cdrs)

        await eventually(arrives)
        assert set(before.cdrs) == {b"picture"}
        await eventually(
            lambda: ["backends:cpu:" in each for each in publisher.subscriptions] == [True]
        )
        plain = publisher.plain
        after = subscribe(source, "/image", IMAGE)
        publisher.publish(b"next")
        await eventually(lambda: b"next" in before.cdrs)
        assert publisher.plain == plain
        await eventually(lambda: len(publisher.subscriptions) == 2)

        def both() -> bool:
            publisher.publish(b"last")
            return b"last" in before.cdrs and b"last" in after.cdrs

        await eventually(both)
        assert publisher.plain == plain
        publisher.close()
        usual = world.add_publisher("/image", IMAGE)  # of Jazzy

        def is_heard() -> bool:
            usual.publish(b"usual")
            return b"usual" in after.cdrs

        await eventually(is_heard)


def ends(source: Any) -> Any:
    return source.known.endpoints("MP", "/image")
