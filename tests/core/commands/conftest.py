# SPDX-License-Identifier: Apache-2.0
"""A router with a guard that does what a test says, and a robot that hears commands."""

import json
import time
from collections.abc import AsyncIterator, Callable, Collection, Sequence
from concurrent.futures import ThreadPoolExecutor

import pytest

from gateway.access.audit import Audit
from gateway.codec.types import Types
from gateway.config.control import ControlConfig
from gateway.core.router import Router
from gateway.drive.effects import GuardState
from gateway.sources.source import Sample
from schemas.installed import InstalledDefinitions
from schemas.table import Table
from tests.client import Frame
from tests.core.conftest import LIMITS, Bench, Socketless
from tests.sources.fake import FakeRos

TWIST = "geometry_msgs/msg/Twist"
STAMPED = "geometry_msgs/msg/TwistStamped"


class FakeGuard:
    """A guard that notes its messages. `report` answers in its place."""

    def __init__(self) -> None:
        self.told: list[tuple[object, ...]] = []
        self.is_ready = True
        self.losses = 0
        self.on_state: dict[str, Callable[[GuardState], None]] = {}
        self.on_moving: Callable[[], None] = lambda: None

    def open(
        self,
        topic: str,
        type_name: str,
        readers: Collection[str],
        on_state: Callable[[GuardState], None],
    ) -> None:
        self.told.append(("open", topic, type_name, len(readers)))
        self.on_state[topic] = on_state
        if self.is_ready:
            on_state("ready")

    def prove(self, topic: str, stamp_offset_ns: int, frame_id: str) -> None:
        self.told.append(("prove", topic, frame_id))

    def close(self, topic: str) -> None:
        self.told.append(("close", topic))
        self.on_state.pop(topic)

    def moving(self, topic: str, stamp_offset_ns: int, frame_id: str) -> None:
        self.told.append(("moving", topic, frame_id))
        self.on_moving()

    def rest(self, topic: str) -> None:
        self.told.append(("rest", topic))

    def report(self, state: GuardState) -> None:
        for on_state in list(self.on_state.values()):
            on_state(state)

    @property
    def verbs(self) -> list[object]:
        return [told[0] for told in self.told]


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


def speeds(heard: list[Frame]) -> list[float]:
    return [twist["linear"]["x"] for twist in heard]


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
            ros, guard = FakeRos(), FakeGuard()
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
                guard=guard,
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
