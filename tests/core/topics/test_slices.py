# SPDX-License-Identifier: Apache-2.0
"""Jobs of counted steps, and a clock that only they advance."""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass, field

import pytest

from gateway.core.topics.slices import MAX_JOBS, TURN_NS, Slices

STEPS_A_TURN = 5


@dataclass
class Clock:
    now_ns: int = 0

    def __call__(self) -> int:
        return self.now_ns


@dataclass
class Job:
    """So many steps, each a part of a turn. It notes its name in a log."""

    clock: Clock
    name: str
    steps: int
    log: list[str]
    on_end: Callable[[], None] = field(default=lambda: None)

    def step(self) -> bool:
        self.clock.now_ns += TURN_NS // STEPS_A_TURN
        self.log.append(self.name)
        self.steps -= 1
        if not self.steps:
            self.on_end()
        return self.steps > 0


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def slices(clock: Clock) -> Slices:
    return Slices(clock)


async def turns(log: list[str]) -> list[str]:
    """Let the loop run until nothing is added. Return what each of its turns added."""
    seen = []
    while True:
        before = len(log)
        await asyncio.sleep(0)
        if len(log) == before:
            return seen
        seen.append("".join(log[before:]))


def test_a_turn_and_the_slice_that_exceeds_it_are_far_below_the_5_ms_that_others_may_wait():
    assert TURN_NS == 500_000


async def test_work_of_less_than_a_turn_is_done_at_once(slices: Slices, clock: Clock):
    log: list[str] = []
    slices.begin(Job(clock, "a", STEPS_A_TURN - 1, log))
    assert log == ["a"] * (STEPS_A_TURN - 1)
    assert await turns(log) == []


async def test_the_loop_has_its_turn_after_each_slice_of_time(slices: Slices, clock: Clock):
    log: list[str] = []
    slices.begin(Job(clock, "a", 3 * STEPS_A_TURN + 2, log))
    assert len(log) == STEPS_A_TURN
    assert await turns(log) == ["aaaaa", "aaaaa", "aa"]


async def test_jobs_share_each_turn(slices: Slices, clock: Clock):
    log: list[str] = []
    for name in "ab":
        slices.begin(Job(clock, name, 2 * STEPS_A_TURN, log))
    log.clear()
    assert await turns(log) == ["ababa", "babab"]


async def test_so_many_jobs_are_under_way_and_the_next_is_called_when_there_is_room(
    slices: Slices, clock: Clock
):
    assert MAX_JOBS == 4
    log: list[str] = []
    called: list[str] = []
    for number in range(MAX_JOBS):
        assert slices.has_room(lambda: called.append("early"))
        slices.begin(Job(clock, str(number), STEPS_A_TURN + 1 + number, log))

    def waits() -> None:
        called.append(log[-1])

    assert [slices.has_room(waits), slices.has_room(waits)] == [False, False]
    await turns(log)
    assert called == ["0"]
    assert slices.has_room(waits)


async def test_a_job_that_begins_when_another_ends_is_not_lost(slices: Slices, clock: Clock):
    log: list[str] = []

    def begin_another() -> None:
        slices.begin(Job(clock, "b", 2 * STEPS_A_TURN, log))

    slices.begin(Job(clock, "a", STEPS_A_TURN + 1, log, begin_another))
    await turns(log)
    assert (log.count("a"), log.count("b")) == (STEPS_A_TURN + 1, 2 * STEPS_A_TURN)
