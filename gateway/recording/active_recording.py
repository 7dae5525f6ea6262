# SPDX-License-Identifier: Apache-2.0
"""A recording that is under way: its subscriptions, its episodes, and the topic of events."""

import json
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import datetime, timezone
from pathlib import Path
from typing import Any, Final, Literal

from gateway.access.permissions import UNLIMITED, Identity, compile_globs
from gateway.codec.picture import COMPRESSED_IMAGE, IMAGE
from gateway.codec.types import Types
from gateway.core.errors import ProtocolError
from gateway.core.frames import PlainFraming
from gateway.core.requests import ImageRequest, Subscribe
from gateway.core.rosapi.typedefs import full_text
from gateway.core.router import Router
from gateway.core.topics.subscription import Subscription
from gateway.recording.entries import RecordedMessage, RecordedNote, RecordedTopic, qos_text
from gateway.recording.session import (
    MAX_WAITING_PICTURES,
    RecordedOutbox,
    RecordingSession,
)
from gateway.recording.writer import MAX_WAITING_NOTES, RecordingWriter, State
from gateway.sources.source import Qos
from schemas.type_hash import type_hash

EVENTS: Final = "/ros2_gateway/events"
_STRING: Final = "std_msgs/msg/String"
_EVENTS_OFFER: Final = Qos()
JPEG_TOPIC: Final = "/compressed"  # image_transport ends the name of a camera's JPEGs by it


@dataclass(frozen=True, kw_only=True)
class RecordingPlan:
    """The topics to record, and for whom. Without globs, all topics that are not hidden."""

    topics: Sequence[str] = ()
    images: Literal["raw", "jpeg"] = "raw"
    task: str = ""
    operator: str = ""
    identity: Identity = UNLIMITED


@dataclass(frozen=True, kw_only=True)
class RecordingStatus:
    """The current recording, or the last one."""

    state: State
    path: Path | None = None
    topics: int = 0
    messages: int = 0
    size: int = 0
    duration_s: float = 0
    dropped: int = 0  # as the disk or a worker was too slow
    lost: int = 0  # before they came to the gateway
    episode: int | None = None  # the number of the one that is open
    why: str = ""  # it ended by itself
    problems: dict[str, str] = field(default_factory=dict)  # by topic


@dataclass(frozen=True, kw_only=True)
class Mark:
    """Something that an operator says while recording. *success* is of the episode that ends."""

    text: str = ""
    episode: Literal["start", "end"] | None = None
    task: str | None = None  # of the episode that starts, None for the last one
    success: bool | None = None


class ActiveRecording:
    """Subscribes to what a plan names, also to topics that come later, until it is stopped.

    Lives on the event loop's thread.
    """

    def __init__(
        self, router: Router, types: Types, writer: RecordingWriter, plan: RecordingPlan
    ) -> None:
        self.is_stopping = False
        self.is_over = False
        self._router = router
        self._types = types
        self._writer = writer
        self._plan = plan
        self._globs = compile_globs(plan.topics or ("**",))
        self._names_hidden = bool(plan.topics)  # else hidden topics are left out
        self._began_s = time.monotonic()
        self._ended_s: float | None = None
        self._lost = 0  # as counted at the end
        self._topics: dict[str, tuple[str, RecordedTopic]] = {}  # by name: what feeds it
        self._asked: set[str] = set()
        self._episode = -1
        self._is_in_episode = False
        self._events = self._describe(EVENTS, _STRING, [_EVENTS_OFFER])
        self._outbox = RecordedOutbox(self._open_topic, writer.put)
        self._session = RecordingSession(router, plan.identity, self._outbox)
        self._pictures = PlainFraming.of_pictures(types) if plan.images == "jpeg" else None
        self._begin_episode(plan.task)
        for drive in router.control().drives:
            state = {"is_controlled": drive.is_leased, "is_tripped": drive.is_tripped}
            offset_ms = drive.clock_offset_ms
            clock = {} if offset_ms is None else {"clock_offset_ms": offset_ms}
            self._write_event("control", topic=drive.topic, **state, **clock)
        router.enter(self._session)
        self._watch = router.ros.watch_graph(self._follow)
        self._follow()

    @property
    def folder(self) -> Path:
        """The directory of its files. The name may change until the first one is open."""
        return self._writer.folder

    def mark(self, mark: Mark, identity: Identity) -> None:
        """Write a mark as an event, and begin or end an episode.

        Raises:
            ProtocolError: there is no episode to end, or too many wait for the disk.
        """
        if mark.episode == "end" and not self._is_in_episode:
            raise ProtocolError("not_found", "no episode is open: start one first")
        if mark.episode is not None and self._writer.is_full_of_notes:
            text = f"at most {MAX_WAITING_NOTES} starts and ends of episodes wait for the disk"
            raise ProtocolError("limit_exceeded", f"{text}: mark fewer of them per second")
        if mark.episode is not None:
            self._end_episode(mark.success)
        if mark.episode == "start":
            self._begin_episode(self._plan.task if mark.task is None else mark.task)
        more = {} if mark.episode is None else {"episode": mark.episode}
        self._write_event("mark", text=mark.text, name=identity.name, role=identity.role, **more)

    def write_event(self, line: str) -> None:
        """Write an event, which is an object in JSON."""
        cdr = self._types.get(_STRING).encode({"data": line}, 0)
        now_ns = time.time_ns()
        self._writer.put(RecordedMessage(now_ns, now_ns, self._events, cdr))

    def stop(self, *, success: bool | None = None) -> None:
        """Subscribe to nothing any more, and have the file completed."""
        self.is_stopping = True
        self._leave()
        self._end_episode(success)
        self._writer.stop()

    def join(self, timeout_s: float) -> None:
        """Wait until the file is complete."""
        self._writer.join(timeout_s)

    def end(self) -> None:
        """Take note that nothing more is written."""
        self.is_stopping = self.is_over = True
        self._leave()

    def status(self) -> RecordingStatus:
        """Return its state in numbers."""
        writer = self._writer
        ended_s = time.monotonic() if self._ended_s is None else self._ended_s
        dropped = sum(writer.waiting.dropped().values())
        return RecordingStatus(
            state=writer.state,
            path=writer.folder,
            topics=len(self._topics),
            messages=writer.messages,
            size=writer.size,
            duration_s=ended_s - self._began_s,
            dropped=dropped,
            lost=self._lost + self._outbox.lost,
            episode=self._episode if self._is_in_episode else None,
            why=writer.why,
            problems=self._session.problems,
        )

    def _leave(self) -> None:
        if self._ended_s is None:
            self._ended_s = time.monotonic()
            self._lost = self._outbox.lost
            self._watch.close()
            self._router.leave(self._session)

    def _follow(self) -> None:
        """Subscribe to topics of the plan that are new in the graph."""
        types = self._router.ros.topics()
        for name, type_names in types.items():
            if name not in self._asked and self._is_wanted(name):
                is_camera = self._pictures is not None and IMAGE in type_names
                # a camera's own JPEGs are recorded instead of ours
                if is_camera and self._is_wanted(name + JPEG_TOPIC) and name + JPEG_TOPIC in types:
                    continue
                self._asked.add(name)
                self._router.carry_out(self._session, self._subscribe(name, is_camera=is_camera))

    def _subscribe(self, name: str, *, is_camera: bool) -> Subscribe:
        if not is_camera or self._pictures is None:
            return Subscribe(topic=name, framing=PlainFraming())
        image = ImageRequest(format="jpeg", asks_for_picture=True, adapts=False)
        return Subscribe(
            topic=name, framing=self._pictures, image=image, queue_length=MAX_WAITING_PICTURES
        )

    def _is_wanted(self, name: str) -> bool:
        is_hidden = "/_" in name and not self._names_hidden
        matches = self._globs is not None and self._globs.fullmatch(name) is not None
        return matches and not is_hidden and name != EVENTS and self._session.may("subscribe", name)

    def _open_topic(self, subscription: Subscription) -> RecordedTopic | None:
        """Return the topic of a subscription's samples in the file, if it can have them."""
        feed = subscription.source
        if feed is None:
            return None
        name: str = feed.topic.name
        type_name = feed.topic.type_name
        if feed.encoding.image is not None:
            name, type_name = name + JPEG_TOPIC, COMPRESSED_IMAGE
        if name not in self._topics:
            topic = self._describe(name, type_name, self._router.offers(feed.topic))
            self._topics[name] = feed.topic.name, topic
        source, topic = self._topics[name]
        if source == feed.topic.name and topic.type_name == type_name:
            return topic
        # rosbags loses messages of a file in which a topic has two channels
        text = f"{name} is in the file with type {topic.type_name}: start another recording"
        self._session.warn(ProtocolError("type_conflict", text), subscription.newest_request)
        return None

    def _describe(self, name: str, type_name: str, offers: Sequence[Qos]) -> RecordedTopic:
        definitions = self._types.definitions
        text = full_text(type_name, definitions)
        hash_text = type_hash(self._types.get(type_name).definition, definitions)
        return RecordedTopic(name, type_name, text, hash_text, qos_text(offers))

    def _begin_episode(self, task: str) -> None:
        self._episode += 1
        self._is_in_episode = True
        self._note("start", task=task, operator=self._plan.operator or self._plan.identity.name)

    def _end_episode(self, success: bool | None) -> None:
        if self._is_in_episode:
            self._is_in_episode = False
            self._note("end", success="" if success is None else str(success).lower())

    def _note(self, name: str, **values: str) -> None:
        values["time_ns"] = str(time.time_ns())
        self._writer.note(RecordedNote(f"episode/{self._episode}/{name}", values))

    def _write_event(self, event: str, **values: Any) -> None:
        now = datetime.now(timezone.utc).isoformat(timespec="milliseconds")
        self.write_event(json.dumps({"time": now, "event": event, **values}))
