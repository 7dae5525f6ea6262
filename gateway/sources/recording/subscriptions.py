# SPDX-License-Identifier: Apache-2.0
"""Subscriptions to what is played, and the messages that wait for late subscribers."""

import asyncio
import itertools
import time
from collections.abc import Callable, Container, Iterable, Sequence
from itertools import groupby

from gateway.sources.recording.tracks import NewestMessages, Recorded, Stream, Track
from gateway.sources.source import MAX_TAKES_PER_TURN, Qos, Sample, TopicEvent

OnSamples = Callable[[Sequence[Sample]], None]


class RecordingSubscription:
    """Implements `gateway.sources.source.RosSubscription`. No sample of it is lost."""

    lost = 0
    incompatible: tuple[TopicEvent, ...] = ()

    def __init__(
        self, all_of_them: "RecordingSubscriptions", stream: Stream, qos: Qos, on_samples: OnSamples
    ) -> None:
        self.qos = qos
        self.offers = (qos,)
        self.publishers = int(stream in all_of_them.streams)
        self._all, self._stream = all_of_them, stream
        self._on_samples = on_samples
        self.is_open = True
        all_of_them.add(stream, self)

    def join_late(self, on_samples: OnSamples) -> "RecordingSubscription":
        """Subscribe once more."""
        return RecordingSubscription(self._all, self._stream, self.qos, on_samples)

    def deliver(self, samples: Sequence[Sample]) -> None:
        """Give samples, some at a time, until it is closed."""
        for first in range(0, len(samples), MAX_TAKES_PER_TURN):
            if self.is_open:
                self._on_samples(samples[first : first + MAX_TAKES_PER_TURN])

    def close(self) -> None:
        """End it. No callback follows."""
        self.is_open = False
        self._all.remove(self._stream, self)


class RecordingSubscriptions:
    """All of them, by topic and type. *streams* are those that are recorded."""

    def __init__(self, streams: Container[Stream]) -> None:
        self.streams = streams
        self._open: dict[Stream, dict[RecordingSubscription, None]] = {}
        self._held: dict[Stream, dict[Track, NewestMessages[Sample]]] = {}  # for late subscribers
        self._numbers = itertools.count()

    def add(self, stream: Stream, subscription: RecordingSubscription) -> None:
        """Deliver what is held, soon, and then what is played."""
        asyncio.get_running_loop().call_soon(self._join, stream, subscription)

    def remove(self, stream: Stream, subscription: RecordingSubscription) -> None:
        """Deliver no more."""
        readers = self._open.get(stream, {})
        readers.pop(subscription, None)
        if not readers:
            self._open.pop(stream, None)

    def has(self, stream: Stream) -> bool:
        """Return whether a client gets it."""
        return stream in self._open

    def forget_held(self, streams: Iterable[Stream]) -> None:
        """Hold nothing of these any more, because time has jumped."""
        for stream in streams:
            self._held.pop(stream, None)

    def play(self, messages: Sequence[Recorded]) -> None:
        """Deliver messages in their order, those of one topic that follow each other at once."""
        for track, together in groupby(messages, key=_track):
            if track.held or track.stream in self._open:
                self.deliver(track, [self.sample(each.cdr, each.time_ns) for each in together])

    def deliver(self, track: Track, samples: Sequence[Sample]) -> None:
        """Deliver samples, and hold them for late subscribers if the topic is latched."""
        if track.held:
            of_stream = self._held.setdefault(track.stream, {})
            newest = of_stream.setdefault(track, NewestMessages(track.held))
            for sample in samples:
                newest.add(sample)
        for subscription in list(self._open.get(track.stream, ())):
            subscription.deliver(samples)

    def _join(self, stream: Stream, subscription: RecordingSubscription) -> None:
        if not subscription.is_open:
            return
        self._open.setdefault(stream, {})[subscription] = None
        of_stream = self._held.get(stream, {}).values()
        held = [sample for newest in of_stream for sample in newest.messages]
        if held:
            subscription.deliver(sorted(held, key=_number))

    def sample(self, cdr: bytes, time_ns: int) -> Sample:
        """Return a sample. Its number is not that of another one, even if it is played again."""
        return Sample(cdr, time.time_ns(), time_ns, next(self._numbers))


def _track(each: Recorded) -> Track:
    return each.track


def _number(sample: Sample) -> int:
    return sample.number or 0
