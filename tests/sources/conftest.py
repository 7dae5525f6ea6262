# SPDX-License-Identifier: Apache-2.0
"""ROS for tests, real and fake, each with the world around it."""

import contextlib
import os
import time
from collections.abc import AsyncIterator, Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, Final, NamedTuple, TypeVar

import pytest

from gateway.sources.options import ZENOH_RMW
from gateway.sources.rclpy import RosOptions, open_ros
from gateway.sources.rclpy.message_classes import MessageClasses
from gateway.sources.rclpy.port import RclpyRos
from gateway.sources.recording.options import PlayOptions
from gateway.sources.recording.port import RecordingSource
from gateway.sources.recording.recording import Recording
from gateway.sources.recording.tracks import Recorded as Played
from gateway.sources.recording.tracks import Track
from gateway.sources.source import Qos
from schemas.definition_text import parse_definition
from schemas.installed import InstalledDefinitions
from tests.sources.fake import FakeRos
from tests.sources.outside import Outside
from tests.sources.replayed import Recorded, ReplaySource


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with what depends on the version of rclpy alone: it explains what fails later."""
    items.sort(key=lambda item: item.path.name != "test_rclpy_private.py")


T = TypeVar("T")


class MadeClasses(MessageClasses):
    """Makes the classes of all types, as if no package were installed."""

    def __init__(self, definitions: InstalledDefinitions | None = None) -> None:
        self._known = InstalledDefinitions() if definitions is None else definitions
        super().__init__(self._known)
        self.allow_made_types()

    def _find(self, find: Callable[[], T], make: Callable[[InstalledDefinitions], T]) -> T:
        find()  # refuses bad names
        return make(self._known)


class Recorder(NamedTuple):
    """The world of a recording, which only publishes."""

    source: ReplaySource

    def add_publisher(self, topic: str, type_name: str, _: Qos | None = None) -> Any:
        self.source.types[topic] = (type_name,)

        def publish(cdr: bytes) -> None:
            self.source.deliver(Recorded(0, topic, type_name, cdr))

        return SimpleNamespace(publish=publish)

    def add_described_publisher(self, topic: str, type_name: str, text: str) -> None:
        self.source.carried[type_name] = parse_definition(type_name, text)
        self.add_publisher(topic, type_name)


class Player(NamedTuple):
    """The world of a recording that is played from files, which here come as it goes."""

    source: RecordingSource
    system_ns: Callable[[], int] = time.time_ns  # its own time is that of the recording

    def add_publisher(self, topic: str, type_name: str, _: Qos | None = None) -> Any:
        track = Track(topic, type_name)
        self.source._add(track)

        def publish(cdr: bytes) -> None:
            self.source._play([Played(time.time_ns(), track, cdr)])

        return SimpleNamespace(publish=publish)

    def add_described_publisher(self, topic: str, type_name: str, text: str) -> None:
        self.source._carried[type_name] = parse_definition(type_name, text)
        self.add_publisher(topic, type_name)


@dataclass(frozen=True)
class Robot:
    """The port under test and the world around it."""

    ros: Any
    world: Any


def known_to(ros: RclpyRos, service: str) -> bool:
    """Return whether the gateway has discovered a client: it loses responses to others."""
    return ros._debug.count_clients(service) > 0


@pytest.fixture
def outside() -> Iterator[Outside]:
    outside = Outside()
    yield outside
    outside.close()


PARTS: Final = ("publishing", "services", "actions", "diagnosis")
# Zenoh keeps no publisher and subscription apart, also below rclpy
IS_ZENOH: Final = os.environ.get("RMW_IMPLEMENTATION") == ZENOH_RMW
needs_qos = pytest.mark.skipif(IS_ZENOH, reason=f"{ZENOH_RMW} has no such QoS")
OF_RCLPY: Final = PARTS if IS_ZENOH else (*PARTS, "qos")
SOURCES: Final[Mapping[str, Sequence[str]]] = {
    "fake": (*PARTS, "qos"),
    "rclpy": OF_RCLPY,
    # of a package that is not installed, for which Fast DDS is needed
    **({} if IS_ZENOH else {"made": OF_RCLPY}),
    "replayed": (),
    "recording": (),  # its only services are those of the player
    "zenoh": PARTS,
}


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Try each source that has the `parts` that a test needs: all of them, unless it says so."""
    if "robot" in metafunc.fixturenames:
        marker = metafunc.definition.get_closest_marker("parts")
        needed = set(PARTS if marker is None else marker.args)
        able = [name for name, parts in SOURCES.items() if needed <= set(parts)]
        metafunc.parametrize("robot", able, indirect=True)


@pytest.fixture
async def robot(request: pytest.FixtureRequest) -> AsyncIterator[Robot]:
    async with contextlib.asynccontextmanager(_open_robot)(request) as robot:
        parts = tuple(part for part in PARTS if getattr(robot.ros, part) is not None)
        able = tuple(each for each in SOURCES[request.param] if each != "qos")
        assert parts == able or request.param == "recording"
        yield robot


async def _open_robot(request: pytest.FixtureRequest) -> AsyncIterator[Robot]:
    if request.param == "fake":
        fake = FakeRos()
        yield Robot(fake, fake)
        return
    if request.param == "replayed":
        replayed = ReplaySource({})
        yield Robot(replayed, Recorder(replayed))
        return
    if request.param == "recording":
        source = RecordingSource(Recording([]), PlayOptions(), InstalledDefinitions())
        with contextlib.closing(source):
            yield Robot(source, Player(source))
        return
    if request.param == "zenoh":
        from tests.sources.zenoh.conftest import open_robot

        with open_robot() as (source, world):
            yield Robot(source, world)
        return
    outside = request.getfixturevalue("outside")
    if request.param == "made":
        made = RclpyRos(RosOptions(), MadeClasses())
        outside.is_known = lambda service: known_to(made, service)
        with contextlib.closing(made):
            yield Robot(made, outside)
        return
    async with open_ros(definitions=InstalledDefinitions()) as ros:
        outside.is_known = lambda service: known_to(ros, service)
        yield Robot(ros, outside)
