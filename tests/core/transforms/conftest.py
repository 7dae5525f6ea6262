# SPDX-License-Identifier: Apache-2.0
"""A robot that publishes frames over the fake ROS, and a client."""

from typing import Any

import pytest

from gateway.sources.source import Qos
from gateway.tf import TF_MESSAGE
from gateway.tf.buffer import Buffer, FoundTransform
from tests.core.conftest import Bench, Socketless
from tests.sources.fake import FakePublisher

LATCHED = Qos(durability="transient_local")


class Robot:
    """A publisher of frames."""

    def __init__(self, bench: Bench) -> None:
        self.bench = bench
        self.moving = bench.ros.add_publisher("/tf", TF_MESSAGE)
        self.fixed = bench.ros.add_publisher("/tf_static", TF_MESSAGE, LATCHED)
        self.say(self.fixed, "laser", "base_link", 0, 1.0)

    def say(
        self, publisher: FakePublisher, child: str, parent: str, sec: int, x: float, **other: Any
    ) -> None:
        stamped = {
            "header": {"stamp": {"sec": sec, "nanosec": 0}, "frame_id": parent},
            "child_frame_id": child,
            "transform": {"translation": {"x": x}, **other},
        }
        publisher.publish(self.bench.cdr(TF_MESSAGE, transforms=[stamped]))

    def drive(self, sec: int, x: float) -> None:
        self.say(self.moving, "base_link", "odom", sec, x)

    async def drives(self, sec: int, x: float) -> None:
        """Drive as soon as the gateway listens."""
        await self.bench.settle()
        self.drive(sec, x)

    @property
    def warnings(self) -> list[str]:
        return [text for _, text in self.bench.ros.logged if text.startswith("tf: ")]

    @property
    def subscriptions(self) -> list[str]:
        return [subscription.topic for subscription in self.bench.ros.subscriptions]


@pytest.fixture
def robot(bench: Bench) -> Robot:
    return Robot(bench)


@pytest.fixture
def client(bench: Bench) -> Socketless:
    return bench.client()


@pytest.fixture
def looks(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, str]]:
    """Return what is looked up from now on."""
    looks = []
    lookup = Buffer.lookup

    def noted(
        buffer: Buffer, target: str, source: str, stamp_ns: int | None = None
    ) -> FoundTransform:
        looks.append((target, source))
        return lookup(buffer, target, source, stamp_ns)

    monkeypatch.setattr(Buffer, "lookup", noted)
    return looks
