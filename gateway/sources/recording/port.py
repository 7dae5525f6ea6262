# SPDX-License-Identifier: Apache-2.0
"""A recording, as the gateway serves it."""

import contextlib
from collections.abc import AsyncIterator, Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from gateway.config.model import Config
from gateway.sources.graph import Graph, TopicInfo
from gateway.sources.qos import is_latched
from gateway.sources.recording.controls import PLAYER_NODE, REFUSAL, Controls
from gateway.sources.recording.errors import RecordingError
from gateway.sources.recording.opening import opened
from gateway.sources.recording.options import PlayOptions
from gateway.sources.recording.own_topics import CLOCK, OWN_TYPES, STATE, OwnTopics, clock_ns
from gateway.sources.recording.player import Player
from gateway.sources.recording.recording import Recording
from gateway.sources.recording.subscriptions import (
    OnSamples,
    RecordingSubscription,
    RecordingSubscriptions,
)
from gateway.sources.recording.tracks import DEFAULT_QOS, Recorded, Stream, Track
from gateway.sources.source import Qos, RosError, TopicEvent
from schemas.definition import Definition
from schemas.definition_text import parse_definition
from schemas.installed import InstalledDefinitions

_NS_PER_S: Final = 1_000_000_000


class RecordingSource:
    """Implements `gateway.sources.source.Source`: it publishes nothing, and has no actions."""

    publishing = actions = diagnosis = None
    refusal = REFUSAL
    distro = "recording"
    network: Final[Mapping[str, str | int]] = {}

    def __init__(
        self, recording: Recording, options: PlayOptions, definitions: InstalledDefinitions
    ) -> None:
        own = {name: parse_definition(name, text) for name, text in OWN_TYPES.items()}
        self._carried = {**own, **recording.definitions}
        definitions.tell(self._carried)
        self._types: dict[str, tuple[str, ...]] = {}
        self._offers: dict[Stream, Qos] = {}
        self._subscriptions = RecordingSubscriptions(self._offers)
        for track in recording.tracks:
            self._add(track)
        self._latched = [each.stream for each in recording.tracks if each.is_latched]
        self._has_clock = CLOCK.topic in self._types
        if not self._has_clock:
            self._add(CLOCK)
        self._add(STATE)
        self._clock_ns: int | None = None  # of a recorded clock
        self._on_jump_back: dict[Watching, Callable[[], None]] = {}
        self._player = Player(
            recording, options, self._play, self._show_latched, self._tell_jump_back
        )
        self.services = Controls(self._player, definitions)
        self._own = OwnTopics(self._player, self._subscriptions, has_clock=self._has_clock)

    def close(self) -> None:
        """Play no more, and close the files."""
        self._own.close()
        self._player.close()

    # The graph

    def topics(self) -> Mapping[str, Sequence[str]]:
        """Return the types of all topics."""
        return self._types

    def topic_types(self, topic: str) -> tuple[str, ...]:
        """Return the types of a topic."""
        return self._types.get(topic, ())

    def service_types(self, service: str) -> tuple[str, ...]:
        """Return the type of a service of the player."""
        found = self.services.types.get(service)
        return () if found is None else (found,)

    def action_types(self, _: str) -> tuple[str, ...]:
        """Return nothing: a recording has no actions."""
        return ()

    def graph(self) -> Graph:
        """Return the topics, and the node that plays them."""
        topics = (
            TopicInfo(name, types, (PLAYER_NODE,), (), self._is_latched(name, types))
            for name, types in sorted(self._types.items())
        )
        return Graph(tuple(topics), (PLAYER_NODE,), self.services.servers())

    def _is_latched(self, name: str, types: Sequence[str]) -> bool:
        return is_latched([self._offers.get((name, each), DEFAULT_QOS) for each in types])

    def watch_graph(self, _: Callable[[], None]) -> "Watching":
        """Call nobody, because the topics stay."""
        return Watching(self._on_jump_back)

    async def definitions(self, type_name: str) -> Mapping[str, Definition] | None:
        """Return all definitions of the files."""
        return self._carried if type_name in self._carried else None

    # Time

    def now_ns(self) -> int:
        """Return the recorded clock, or else the position of the player."""
        return self._player.position_ns if self._clock_ns is None else self._clock_ns

    def watch_jumps_back(self, on_jump: Callable[[], None]) -> "Watching":
        """Call *on_jump* when the player has jumped back."""
        watching = Watching(self._on_jump_back)
        self._on_jump_back[watching] = on_jump
        return watching

    # Topics

    def subscribe(
        self,
        topic: str,
        type_name: str,
        qos: Qos,
        on_samples: OnSamples,
        on_event: Callable[[TopicEvent], None],
    ) -> RecordingSubscription:
        """Deliver what is played from now on, and before it what the topic holds."""
        del on_event  # nothing keeps these samples from coming
        types = self._types.get(topic, (type_name,))
        if type_name not in types:
            raise RosError("type_conflict", f"topic {topic} has type {types[0]}")
        offered = self._offers.get((topic, type_name), DEFAULT_QOS)
        adopted = replace(offered, depth=qos.depth or offered.depth)
        return RecordingSubscription(self._subscriptions, (topic, type_name), adopted, on_samples)

    def _add(self, track: Track) -> None:
        if track.stream not in self._offers:
            self._offers[track.stream] = track.qos
            types = (*self._types.get(track.topic, ()), track.type_name)
            self._types[track.topic] = tuple(sorted(types))

    def _play(self, messages: Sequence[Recorded]) -> None:
        if self._has_clock:
            for each in messages:
                if each.track.stream == CLOCK.stream:
                    self._clock_ns = clock_ns(each.cdr) or self._clock_ns
        self._subscriptions.play(messages)

    def _show_latched(self, messages: Sequence[Recorded]) -> None:
        self._subscriptions.forget_held(self._latched)
        self._subscriptions.play(messages)

    def _tell_jump_back(self) -> None:
        for on_jump in list(self._on_jump_back.values()):
            on_jump()


class Watching:
    """Implements `gateway.sources.source.Watch`."""

    def __init__(self, registered: "dict[Watching, Callable[[], None]]") -> None:
        self._registered = registered

    def close(self) -> None:
        """End it. No callback follows."""
        self._registered.pop(self, None)


@contextlib.asynccontextmanager
async def open_source(
    paths: Sequence[Path], options: PlayOptions, _: Config, definitions: InstalledDefinitions
) -> AsyncIterator[RecordingSource]:
    """Play files until the context ends.

    Raises:
        RecordingError: they cannot be played.
    """
    recording = await opened(paths)
    seconds = (recording.end_ns - recording.start_ns) / _NS_PER_S
    if options.start_s > seconds:
        recording.close()
        raise RecordingError(
            f"--start {options.start_s:g} is behind the end, at {seconds:.1f} s: begin earlier"
        )
    source = RecordingSource(recording, options, definitions)
    try:
        yield source
    finally:
        source.close()
