# SPDX-License-Identifier: Apache-2.0
"""A router with a guard that does what a test says, and a robot that hears commands."""

import json
import time
from collections.abc import AsyncIterator, Callable, Sequence
from concurrent.futures import ThreadPoolExecutor

import pytest

from gateway.access.audit import Audit
from gateway.codec.types import Types
from gateway.config.control import ControlConfig
from gateway.core.router import Router
from gateway.sources.source import Sample
from schemas.installed import InstalledDefinitions
from schemas.table import Table
from tests.client import Frame, eventually
from tests.core.conftest import LIMITS, TWIST, Bench, Socketless
from tests.sources.fake import FakeRos
from tests.sources.fake_guard import FakeGuard

STAMPED = "geometry_msgs/msg/TwistStamped"


class Scene(Bench):
    """The bench, with a guard."""

    def __init__(
        self, ros: FakeRos, router: Router, types: Types, guard: FakeGuard, audited: list[str]
    ) -> None:
        super().__init__(ros, router, types)
        self.guard = guard
        self._audited = audited

    @property
    def audited(self) -> list[Frame]:
        """The events of the audit log, without their times."""
        events: list[Frame] = [json.loads(line) for line in self._audited]
        return [{k: v for k, v in event.items() if k != "time"} for event in events]

    def listen(self, topic: str = "/cmd_vel", type_name: str = TWIST) -> list[Frame]:
        heard: list[Frame] = []
        decode = self.types.get(type_name).decode

        def note(samples: Sequence[Sample]) -> None:
            heard.extend(decode(sample.cdr) for sample in samples)

        self.ros.add_subscription(topic, type_name, note)
        return heard

    async def driven(self) -> tuple[Socketless, list[Frame]]:
        """Return a client whose first command the robot has heard, and what it hears."""
        heard = self.listen()
        client = self.client()
        push(client)
        await eventually(lambda: len(heard) == 1)
        return client, heard


def speeds(heard: list[Frame]) -> list[float]:
    return [twist["linear"]["x"] for twist in heard]


async def stopped(heard: list[Frame]) -> None:
    """Wait until a robot that has heard one command has heard the zeros of a stop."""
    await eventually(lambda: speeds(heard)[1:] == [0.0] * 5)


def push(client: Socketless, x: float = 0.2, **more: object) -> None:
    """Publish one command."""
    client.send(op="publish", topic="/cmd_vel", msg={"linear": {"x": x}}, **more)


Build = Callable[..., Scene]


@pytest.fixture
async def build() -> AsyncIterator[Build]:
    """Return a function that makes a scene with some settings."""
    made: list[Scene] = []
    with ThreadPoolExecutor(1) as workers:

        def build(**control: object) -> Scene:
            guard = FakeGuard()
            ros = FakeRos(guard=guard)
            types = Types(InstalledDefinitions())
            audited: list[str] = []
            router = Router(
                ros,
                types,
                Table.load(),
                limits=LIMITS,
                workers=workers,
                version="test",
                control=ControlConfig(**control),  # type: ignore[arg-type]
                audit=Audit(time.time_ns, audited.append),
            )
            made.append(Scene(ros, router, types, guard, audited))
            return made[-1]

        yield build
        for scene in made:
            scene.router.close()
            assert scene.ros.entity_count() == 0


@pytest.fixture
async def scene(build: Build) -> Scene:
    return build()
