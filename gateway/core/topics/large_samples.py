# SPDX-License-Identifier: Apache-2.0
"""Large samples of one encoding: they are encoded in slices, so that no other client waits.

While one is encoded, newer ones wait in the queues, as pictures do while a worker is busy.
"""

import logging
import weakref
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from dataclasses import dataclass, field
from typing import Final, Protocol, TypeAlias

from gateway.codec.cdr import Cdr
from gateway.codec.chunks import Chunk, Chunks
from gateway.codec.error_text import CodecError
from gateway.core.entries import NOT_READY, NOTHING, Frame
from gateway.core.topics.kept_messages import KeptMessages
from gateway.core.topics.shared_pictures import TopicPictures
from gateway.core.topics.slices import Slices
from gateway.sources.source import Sample

logger = logging.getLogger(__name__)

# Encoding so many takes 1.5 ms as int8 in JSON. Of larger samples a queue keeps one by default.
LARGE_SAMPLE_BYTES: Final = 256 * 1024
# The same for types with arrays of messages or texts: 400 poses, which take 2 ms or more.
LARGE_ELEMENTS_BYTES: Final = 32 * 1024
# Smaller pieces are joined: to write thousands takes longer than copying them.
CHUNK_BYTES: Final = 64 * 1024

EncodeInSlices: TypeAlias = Callable[[Cdr], Iterator[Chunk]]
"""From CDR to the pieces of a message, a slice of the work for each, some empty.

It raises `CodecError`.
"""


class LargeSample(Protocol):
    """A sample that waits to be sent."""

    sample: Sample

    def supply(self, message: Frame) -> None:
        """Take the message, or `NOTHING`."""


@dataclass(frozen=True, slots=True)
class EncodingResources:
    """All that encodings share. *workers* encode pictures."""

    workers: Executor
    slices: Slices = field(default_factory=Slices)
    kept: KeptMessages = field(default_factory=KeptMessages)


@dataclass(frozen=True, slots=True)
class EncodedTopic:
    """A topic as its encodings see it."""

    name: str  # resolved, for the log
    on_ready: Callable[[], None]  # called when a sample is encoded that was not at once
    is_latched: Callable[[], bool]  # late subscribers get what was published before
    now_ns: Callable[[], int]  # ROS time
    pictures: TopicPictures = field(default_factory=TopicPictures)


class LargeSamples:
    """Encodes the large samples of one encoding, one at a time.

    A caller that wants another one asks again after *on_ready* of the topic was called. A sample
    that no subscription waits for is not encoded. Messages of a latched topic are kept.
    """

    def __init__(
        self,
        encode: EncodeInSlices,
        on_error: Callable[[CodecError], None],
        topic: EncodedTopic,
        resources: EncodingResources,
    ) -> None:
        self._encode = encode
        self._on_error = on_error
        self._topic = topic
        self._slices = resources.slices
        self._kept = resources.kept
        self._job: _Job | None = None
        self._is_closed = False

    def is_encoding(self, shared: LargeSample) -> bool:
        """Return whether this sample is being encoded right now."""
        return self._job is not None and self._job.shared() is shared

    def encode(self, shared: LargeSample) -> Frame:
        """Return the message if it is made soon or kept, else start to make it."""
        if self._job is not None:
            return NOT_READY
        kept = self._kept.find(self, shared.sample.origin)
        if kept is not None:
            return kept
        if not self._slices.has_room(self._topic.on_ready):
            return NOT_READY
        job = _Job(shared, self._encode(shared.sample.cdr), self._finish)
        self._slices.begin(job)
        if job.is_over:
            return self._message(job)
        self._job = job
        return NOT_READY

    def close(self) -> None:
        """Keep nothing any more."""
        self._is_closed = True
        self._kept.forget(self)

    def _finish(self, job: "_Job") -> None:
        if self._job is not job:
            return  # it has ended at once
        self._job = None
        shared = job.shared()
        if shared is not None:
            origin = shared.sample.origin
            message = self._message(job)
            if isinstance(message, Chunks) and self._topic.is_latched() and not self._is_closed:
                self._kept.keep(self, origin, message)
            shared.supply(message)
        self._topic.on_ready()

    def _message(self, job: "_Job") -> Frame:
        match job.error:
            case None:
                return Chunks.of(job.parts)
            case CodecError():
                self._on_error(job.error)
            case _:
                extra = {"topic": self._topic.name}
                logger.error("encoding a sample failed", exc_info=job.error, extra=extra)
        return NOTHING


class _Job:
    """One sample that is being encoded."""

    def __init__(
        self, shared: LargeSample, made: Iterator[Chunk], on_end: Callable[["_Job"], None]
    ) -> None:
        self.shared = weakref.ref(shared)
        self.parts: list[Chunk] = []
        self.error: Exception | None = None
        self.is_over = False
        self._made = made
        self._on_end = on_end
        self._small: list[Chunk] = []
        self._small_size = 0

    def step(self) -> bool:
        """Make one piece more."""
        if self.shared() is not None:
            try:
                self._add(next(self._made))
            except StopIteration:
                self._join()
            except Exception as error:  # noqa: BLE001  # of one sample
                self.error = error
            else:
                return True
        self.is_over = True
        self._on_end(self)
        return False

    def _add(self, piece: Chunk) -> None:
        if len(piece) >= CHUNK_BYTES:
            self._join()
            self.parts.append(piece)
            return
        if piece:
            self._small.append(piece)
        self._small_size += len(piece)
        if self._small_size >= CHUNK_BYTES:
            self._join()

    def _join(self) -> None:
        if self._small:
            self.parts.append(b"".join(self._small))
            self._small, self._small_size = [], 0
