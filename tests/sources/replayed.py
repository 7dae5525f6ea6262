# SPDX-License-Identifier: Apache-2.0
"""A source that replays a list of samples, without rclpy: the example of adding-a-source.md."""

import asyncio
import contextlib
import itertools
import time
from collections.abc import AsyncIterator, Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

from gateway.config.model import Config
from gateway.sources.graph import Graph, TopicInfo
from gateway.sources.source import MAX_TAKES_PER_TURN, Qos, RosError, Sample, TopicEvent
from schemas.definition import Definition
from schemas.definition_text import parse_definition
from schemas.installed import InstalledDefinitions

NODE = "/replay"
OFFERED = Qos("reliable", "volatile", "keep_last", 10)
OnSamples = Callable[[Sequence[Sample]], None]


class Recorded(NamedTuple):
    """One sample of a recording."""

    after_s: float
    topic: str
    type_name: str
    cdr: bytes


@dataclass(frozen=True, eq=False)
class Subscription:
    """A subscription to a topic of the recording. Nobody else publishes, so it never changes."""

    source: "ReplaySource"
    topic: str
    qos: Qos
    on_samples: OnSamples
    publishers: int = 1
    lost: int = 0
    incompatible: tuple[TopicEvent, ...] = ()

    @property
    def offers(self) -> tuple[Qos, ...]:
        """The offers of the robot."""
        return (self.qos,)

    def join_late(self, _: OnSamples) -> "Subscription":
        """Subscribe once more. This recording keeps nothing for late subscribers."""
        return replace(self, topic="")

    def close(self) -> None:
        """End it. No callback follows."""
        self.source.subscriptions.pop(self, None)


class NothingToWatch:
    """A registration of a callback that is never called."""

    def close(self) -> None:
        """End it."""


class ReplaySource:
    """Implements `gateway.sources.source.Source`: the required part, and no other."""

    publishing = services = actions = diagnosis = None
    distro = "replay"
    network: Final[Mapping[str, str | int]] = {}
    refusal = None

    def __init__(self, definitions: Mapping[str, str]) -> None:
        self.carried = {name: parse_definition(name, text) for name, text in definitions.items()}
        self.subscriptions: dict[Subscription, None] = {}
        self.types: dict[str, tuple[str, ...]] = {}

    def deliver(self, *samples: Recorded) -> None:
        """Give samples of one topic to its subscriptions."""
        now_ns = self.now_ns()
        taken = [Sample(each.cdr, now_ns, now_ns) for each in samples]
        for subscription in list(self.subscriptions):
            for first in range(0, len(taken), MAX_TAKES_PER_TURN):
                if subscription.topic == samples[0].topic and subscription in self.subscriptions:
                    subscription.on_samples(taken[first : first + MAX_TAKES_PER_TURN])

    async def play(self, recording: Sequence[Recorded]) -> None:
        """Replay a recording until cancelled."""
        self.types |= {each.topic: (each.type_name,) for each in recording}
        for each in itertools.cycle(recording):
            await asyncio.sleep(each.after_s)
            self.deliver(each)

    def now_ns(self) -> int:
        """Return the time: the samples count as published now."""
        return time.time_ns()

    async def definitions(self, type_name: str) -> Mapping[str, Definition] | None:
        """Return all definitions, because the file has them anyway."""
        return self.carried if type_name in self.carried else None

    def topics(self) -> Mapping[str, Sequence[str]]:
        """Return the types of all topics."""
        return self.types

    def topic_types(self, topic: str) -> tuple[str, ...]:
        """Return the type of a topic."""
        return self.types.get(topic, ())

    def service_types(self, _: str) -> tuple[str, ...]:
        """Return nothing: a recording has no services."""
        return ()

    action_types = service_types

    def graph(self) -> Graph:
        """Return the topics, and one node that publishes all of them."""
        topics = [TopicInfo(name, types, (NODE,), ()) for name, types in self.types.items()]
        return Graph(tuple(sorted(topics, key=lambda each: each.name)), (NODE,))

    def watch_graph(self, _: Callable[[], None]) -> NothingToWatch:
        """Call nobody, because the topics stay."""
        return NothingToWatch()

    watch_jumps_back = watch_graph

    def subscribe(
        self,
        topic: str,
        type_name: str,
        qos: Qos,
        on_samples: OnSamples,
        on_event: Callable[[TopicEvent], None],
    ) -> Subscription:
        """Deliver what is replayed from now on."""
        del on_event  # nothing keeps these samples from coming
        if type_name not in self.topic_types(topic) and topic in self.types:
            raise RosError("type_conflict", f"topic {topic} has type {self.types[topic][0]}")
        subscription = Subscription(
            self, topic, replace(OFFERED, depth=qos.depth or 10), on_samples
        )
        self.subscriptions[subscription] = None
        return subscription


BATTERY = "replay_msgs/msg/Battery"
RECORDING = [Recorded(0.05, "/battery", BATTERY, b"\0\1\0\0" + bytes([level])) for level in (9, 8)]


@contextlib.asynccontextmanager
async def open_source(_: Config, __: InstalledDefinitions) -> AsyncIterator[ReplaySource]:
    """Replay until the context ends. ``ros2-gateway serve --source`` names this function."""
    source = ReplaySource({BATTERY: "uint8 percent\n"})
    source.types["/battery"] = (BATTERY,)
    playing = asyncio.create_task(source.play(RECORDING))
    try:
        yield source
    finally:
        playing.cancel()
