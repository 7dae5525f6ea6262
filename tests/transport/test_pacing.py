# SPDX-License-Identifier: Apache-2.0
"""The times at which a connection may write, with a link, a clock, and timers of the test."""

from typing import Any

import pytest

from gateway.transport import pacing as pacing_module
from gateway.transport.link import FIRST_WINDOW_BYTES, Reading
from gateway.transport.pacing import Pacing
from tests.transport.timers import Timers


class Paced(Timers):
    """A connection whose peer takes what the test says."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        super().__init__(monkeypatch, pacing_module)
        monkeypatch.setattr(pacing_module, "read_tcp_info", lambda _: self._read())
        self.is_known = True
        self.written = self.acked = self.looks = 0
        self.unsent = 0  # in the transport's own buffer
        self.resumed = 0
        self.rates: list[float] = []
        self.pacing = Pacing(self, self._resume, self.rates.append)  # type: ignore[arg-type]

    def get_extra_info(self, name: str) -> Any:
        assert name == "socket"

    def get_write_buffer_size(self) -> int:
        return self.unsent

    def write(self, size: int) -> None:
        self.written += size
        self.pacing.wrote(size)
        self.check()

    def check(self) -> None:
        """Code that checks only the room does not write during a pause."""
        assert not self.pacing.is_paused or self.pacing.room_bytes <= 0

    def drain(self, bytes_per_s: float, seconds: float) -> None:
        """Let the peer take something, millisecond by millisecond, while it is written to."""
        for _ in range(round(seconds * 1000)):
            self.acked = min(self.written, self.acked + round(bytes_per_s / 1000))
            self.run(0.001)
            self.check()
            while not self.pacing.is_paused:
                self.write(500)

    def _read(self) -> Reading | None:
        self.looks += 1
        on_the_way = self.written - self.acked - self.unsent
        return Reading(self.acked, on_the_way, 0.0) if self.is_known else None

    def _resume(self) -> None:
        assert not self.pacing.is_paused
        self.resumed += 1


@pytest.fixture
def paced(monkeypatch: pytest.MonkeyPatch) -> Paced:
    return Paced(monkeypatch)


def test_only_a_window_is_written_until_some_of_it_is_acknowledged(paced: Paced):
    paced.write(FIRST_WINDOW_BYTES)
    assert not paced.pacing.is_paused
    paced.write(1)
    assert paced.pacing.is_paused
    paced.acked = 1
    paced.run(1)
    assert (paced.pacing.is_paused, paced.resumed) == (False, 1)


def test_bytes_that_the_transport_keeps_count(paced: Paced):
    paced.unsent = FIRST_WINDOW_BYTES + 1
    paced.write(FIRST_WINDOW_BYTES + 1)
    assert paced.pacing.is_paused


def test_a_link_that_takes_everything_at_once_is_looked_at_once_in_a_while(paced: Paced):
    for _ in range(100):
        paced.written += 1000
        paced.acked += 1000
        paced.pacing.wrote(1000)
    assert paced.looks == 1
    assert not paced.pacing.is_paused


def test_a_link_that_was_fast_is_looked_at_often_all_the_same(paced: Paced):
    paced.drain(100e6, 0.5)  # the window is large by now
    paced.acked = paced.written
    paced.run(0.06)
    assert not paced.pacing.is_paused
    paced.looks = 0
    for _ in range(10):
        paced.write(64 * 1024 + 1)
        paced.acked = paced.written
    assert paced.looks >= 10


def test_the_first_look_again_is_in_the_next_turn_and_later_ones_are_rarer(paced: Paced):
    paced.write(10 * FIRST_WINDOW_BYTES)
    waits = [paced.next_turn() for _ in range(12)]
    assert waits[0] == 0
    assert waits[1:4] == pytest.approx([0.001, 0.002, 0.004])
    assert waits[-1] == pytest.approx(0.05)
    assert paced.resumed == 0


def test_after_a_pause_looks_are_frequent_again(paced: Paced):
    paced.write(10 * FIRST_WINDOW_BYTES)
    for _ in range(6):
        paced.next_turn()
    paced.acked = paced.written
    paced.run(1)
    paced.write(10 * FIRST_WINDOW_BYTES)
    assert paced.next_turn() == 0


def test_a_slow_link_is_looked_at_when_it_has_drained(paced: Paced):
    paced.drain(50e3, 3)
    paced.acked = paced.written  # start again, with a known link
    paced.run(0.06)
    while not paced.pacing.is_paused:
        paced.write(500)
    looks = paced.looks
    assert 0.001 < paced.next_turn() <= 0.05
    assert paced.looks == looks + 1


def test_the_rate_of_a_full_link_is_told(paced: Paced):
    paced.drain(50e3, 3)
    assert paced.rates[-1] == pytest.approx(50e3, rel=0.3)
    assert paced.pacing.is_paused


def test_a_full_socket_pauses_too_and_both_must_be_ready(paced: Paced):
    paced.write(FIRST_WINDOW_BYTES + 1)
    paced.pacing.socket_full()
    paced.acked = paced.written
    paced.run(1)
    assert (paced.pacing.is_paused, paced.resumed) == (True, 0)
    paced.check()
    paced.pacing.socket_ready()
    assert (paced.pacing.is_paused, paced.resumed) == (False, 1)


def test_a_ready_socket_does_not_resume_a_full_link(paced: Paced):
    paced.pacing.socket_full()
    paced.write(FIRST_WINDOW_BYTES + 1)
    paced.pacing.socket_ready()
    assert (paced.pacing.is_paused, paced.resumed) == (True, 0)


@pytest.mark.parametrize("is_known", [True, False])
def test_a_full_socket_has_no_room_though_its_link_has(paced: Paced, *, is_known: bool):
    paced.is_known = is_known
    paced.pacing.socket_full()
    paced.check()
    paced.pacing.look()
    paced.check()
    paced.pacing.socket_ready()
    paced.write(1)
    assert paced.pacing.room_bytes > 0


def test_a_part_of_a_picture_that_is_written_during_a_pause_does_not_end_it(paced: Paced):
    paced.write(FIRST_WINDOW_BYTES + 1)
    paced.acked = paced.written
    paced.write(1)  # looks at the drained link, then checks that there is no room
    assert paced.pacing.is_paused


def test_after_closing_it_does_not_look_again(paced: Paced):
    paced.write(FIRST_WINDOW_BYTES + 1)
    paced.pacing.close()
    looks = paced.looks
    paced.run(1)
    assert (paced.looks, paced.resumed) == (looks, 0)


def test_without_a_reading_of_the_kernel_only_the_socket_pauses(paced: Paced):
    paced.is_known = False
    for _ in range(10):
        paced.write(FIRST_WINDOW_BYTES)
    assert not paced.pacing.is_paused
    paced.unsent = 1000
    assert paced.pacing.read() == Reading(-1000, 1000, 0.0)
