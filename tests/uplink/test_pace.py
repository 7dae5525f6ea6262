# SPDX-License-Identifier: Apache-2.0
"""The pace of an uplink, by marks that come back from the router."""

import asyncio

import pytest

from gateway.transport.link import FIRST_WINDOW_BYTES, MIN_WINDOW_BYTES, QUEUE_S
from gateway.uplink import pace
from gateway.uplink.pace import MARK_BYTES, SAMPLE_BYTES, MarkedLink, UplinkPace
from tests.client import eventually


class Route:
    """The way to the router and back, which a test controls."""

    def __init__(self) -> None:
        self.marks: list[int] = []
        self.rates: list[float | None] = []
        self.rooms = self.losses = 0
        self.pace = UplinkPace(
            self.marks.append,
            on_room=self._has_room,
            on_rate=self.rates.append,
            on_lost=self._lose,
        )

    def _has_room(self) -> None:
        self.rooms += 1

    def _lose(self) -> None:
        self.losses += 1


@pytest.fixture
async def route(monkeypatch: pytest.MonkeyPatch):
    assert (pace.IDLE_S, pace.LOST_S, MARK_BYTES) == (1, 5, 4096)
    made = Route()
    yield made
    made.pace.close()


async def test_a_mark_follows_what_was_sent_and_makes_room_when_it_comes_back(route: Route):
    await eventually(lambda: route.marks == [1])  # of a link with nothing to send
    route.pace.returned(1)
    assert route.pace.proved.is_set()
    route.pace.sent(1000)
    route.pace.mark()
    assert route.marks == [1, 2]
    route.pace.sent(MARK_BYTES - 1)
    route.pace.mark()
    assert route.marks == [1, 2]  # one is under way
    route.pace.sent(1)
    route.pace.mark()
    assert route.marks == [1, 2, 3]
    route.pace.sent(FIRST_WINDOW_BYTES)
    assert route.pace.room_bytes <= 0
    route.pace.returned(2)
    assert route.pace.room_bytes <= 0
    assert route.rooms == 2
    route.pace.returned(4)  # the newest of those that were sent, as others may be dropped
    assert route.pace.room_bytes > 0


async def test_marks_of_strangers_change_nothing(route: Route):
    await eventually(lambda: route.marks == [1])
    route.pace.sent(1000)
    for number in (0, -5):
        route.pace.returned(number)
    assert not route.pace.proved.is_set()
    assert route.rooms == 0


async def test_a_link_from_which_nothing_comes_back_is_lost_once(
    route: Route, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(pace, "IDLE_S", 0.01)
    monkeypatch.setattr(pace, "LOST_S", 0.1)
    await eventually(lambda: route.losses == 1)
    count = len(route.marks)
    await asyncio.sleep(0)
    assert (route.losses, len(route.marks)) == (1, count)


def times(link: MarkedLink, size: int, bytes_per_s: float, rtt_s: float, now_s: float) -> float:
    """Send bytes and a mark over a link, and return when the mark is back."""
    back_s = now_s + size / bytes_per_s + rtt_s
    link.read(size, now_s, back_s)
    return back_s


@pytest.mark.parametrize("size", [SAMPLE_BYTES, 32_000])
def test_the_rate_of_a_slow_link_is_found_though_it_pauses(size: int):
    assert (SAMPLE_BYTES, pace.MIN_SAMPLE_S, pace.MIN_RTT_GROWTH) == (4096, 0.001, 1.001)
    link = MarkedLink()
    now_s = times(link, 0, 250_000, 0.04, 1.0)
    for _ in range(40):
        now_s = times(link, size, 250_000, 0.04, now_s)
    assert link.bytes_per_s == pytest.approx(250_000, rel=0.2)
    assert link.window_bytes == pytest.approx(250_000 * (0.04 + QUEUE_S), rel=0.2)
    for _ in range(20):  # of marks that overlap, the time since the one before counts
        link.read(size, now_s - 0.2, now_s + size / 125_000)
        now_s += size / 125_000
    assert link.bytes_per_s == pytest.approx(125_000, rel=0.2)


def test_a_link_that_is_fast_has_no_rate_until_it_is_slow():
    link = MarkedLink()
    now_s = times(link, 0, 1e9, 0.0001, 1.0)
    for _ in range(20):
        now_s = times(link, 32_000, 1e9, 0.0001, now_s)
    assert link.bytes_per_s is None
    for _ in range(3):
        now_s = times(link, 32_000, 50_000, 0.0001, now_s)
    assert link.bytes_per_s == pytest.approx(50_000, rel=0.1)
    for size in (0, SAMPLE_BYTES - 1):
        times(link, size, 1e9, 0.0001, now_s)
    assert link.bytes_per_s == pytest.approx(50_000, rel=0.1)


def test_a_very_slow_link_still_has_a_window():
    link = MarkedLink()
    now_s = times(link, 0, 1000, 0.01, 1.0)
    for _ in range(3):
        now_s = times(link, SAMPLE_BYTES, 1000, 0.01, now_s)
    assert link.window_bytes == MIN_WINDOW_BYTES
