# SPDX-License-Identifier: Apache-2.0
"""The late join alone: a scripted reader next to a topic, with a time that the test sets."""

import asyncio
from collections.abc import Callable, Sequence
from types import SimpleNamespace
from typing import Any

import pytest

from gateway.core.topics import late_join as module
from gateway.core.topics.late_join import LateJoin
from gateway.sources.source import Sample


class Reader:
    """The reader of the late join."""

    def __init__(self, on_samples: Callable[[Sequence[Sample]], None]) -> None:
        self.on_samples = on_samples
        self.publishers = 1
        self.is_closed = False

    def close(self) -> None:
        self.is_closed = True


class Clock:
    """A loop whose time is the test's. One timer at most."""

    def __init__(self) -> None:
        self.now_s = 1000.0
        self.timer: Any = None

    def time(self) -> float:
        return self.now_s

    def call_later(self, delay_s: float, callback: Callable[[], None]) -> Any:
        self.timer = SimpleNamespace(
            at_s=self.now_s + delay_s,
            callback=callback,
            cancel=lambda: setattr(self, "timer", None),
        )
        return self.timer

    def advance(self, seconds: float) -> None:
        end_s = self.now_s + seconds
        while self.timer is not None and self.timer.at_s <= end_s:
            self.now_s, timer, self.timer = self.timer.at_s, self.timer, None
            timer.callback()
        self.now_s = end_s


class Scene:
    """A late join, what it offers, and both ways by which samples come."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.clock = Clock()
        monkeypatch.setattr(
            module, "asyncio", SimpleNamespace(**vars(asyncio) | {"get_running_loop": self.loop})
        )
        self.offered: list[tuple[bytes, int | None]] = []
        self.ended = 0
        self.publishers = 1
        self.seq = 0
        self.join = LateJoin(
            self,  # type: ignore[arg-type]  # what it needs of a subscription
            lambda sample, seq: self.offered.append((sample.cdr, seq)),
            self.end,
        )

    def loop(self) -> Clock:
        return self.clock

    def join_late(self, on_samples: Callable[[Sequence[Sample]], None]) -> Reader:
        self.reader = Reader(on_samples)
        return self.reader

    def end(self) -> None:
        self.ended += 1
        self.join.close()

    def to_reader(self, *numbers: int) -> None:
        self.reader.on_samples([sample(number) for number in numbers])

    def to_topic(self, *numbers: int) -> None:
        for number in numbers:
            self.seq += 1
            if self.join.passes(self.seq, sample(number)):
                self.offered.append((sample(number).cdr, self.seq))

    @property
    def values(self) -> list[int]:
        return [int(cdr) for cdr, _ in self.offered]


def sample(number: int) -> Sample:
    return Sample(str(number).encode(), 0, 5_000 + number, number)


@pytest.fixture
def scene(monkeypatch: pytest.MonkeyPatch) -> Scene:
    return Scene(monkeypatch)


def test_a_sample_that_comes_both_ways_is_sent_once(scene: Scene):
    scene.to_reader(1, 2)
    scene.to_topic(3)
    scene.to_reader(3, 4)
    scene.to_topic(4)
    assert scene.offered == [(b"1", None), (b"2", None), (b"3", 1), (b"4", None)]


def test_the_topic_takes_over_when_nothing_retained_has_come_for_five_seconds(scene: Scene):
    scene.clock.advance(4)
    scene.to_reader(1)
    for number in range(2, 20):  # new ones do not count, whichever way is the first
        scene.clock.advance(0.5)
        assert scene.reader.is_closed is (scene.clock.now_s >= 1010)
        if scene.reader.is_closed:
            break
        ways = [scene.to_reader, scene.to_topic]
        for way in ways if number % 2 else reversed(ways):
            way(number)
    assert scene.ended == 0
    scene.to_topic(50)
    scene.clock.advance(5)
    assert scene.ended == 1
    assert scene.values == [*range(1, number), 50]


def test_publishers_that_the_reader_does_not_know_yet_are_waited_for(scene: Scene):
    scene.publishers = 2
    scene.clock.advance(60)
    assert not scene.reader.is_closed
    scene.reader.publishers = 2
    scene.clock.advance(2.5)
    assert scene.reader.is_closed


def test_a_sample_that_missed_the_reader_comes_from_the_topic(scene: Scene):
    scene.to_topic(1, 2)
    scene.to_reader(2)
    scene.clock.advance(10)
    assert scene.offered == [(b"2", 2), (b"1", 1)]


def test_a_sample_on_its_way_when_the_topic_takes_over_comes_once(scene: Scene):
    scene.to_reader(1)
    scene.clock.advance(5)
    assert scene.reader.is_closed
    assert not scene.ended
    scene.to_topic(1, 2)
    assert scene.values == [1, 2]


def test_samples_that_wait_for_the_reader_are_bounded(
    scene: Scene, monkeypatch: pytest.MonkeyPatch
):
    assert (module.MAX_AHEAD, module.MAX_AHEAD_BYTES) == (256, 8 << 20)
    scene.to_topic(*range(1000, 2000))
    monkeypatch.setattr(module, "MAX_AHEAD_BYTES", 20)
    scene.to_topic(2000)
    scene.clock.advance(5)
    assert scene.values == [1996, 1997, 1998, 1999, 2000]


def test_the_number_that_waits_is_bounded_and_so_is_the_memory_of_what_came(scene: Scene):
    scene.to_topic(*range(1000, 2000))
    scene.to_reader(*range(2000, 4000))
    assert len(scene.join._heard_s) == 1024
    scene.clock.advance(5)
    assert scene.values[2000:] == list(range(1744, 2000))


def test_closing_it_ends_its_reader(scene: Scene):
    scene.join.close()
    scene.join.close()
    assert scene.reader.is_closed
    assert scene.clock.timer is None


def test_one_that_is_cut_short_loses_nothing_that_has_come_to_the_topic(scene: Scene):
    scene.to_topic(1, 2)
    scene.to_reader(1)
    scene.join.cut_short()
    assert scene.offered == [(b"1", 1), (b"2", 2)]
    assert scene.reader.is_closed
