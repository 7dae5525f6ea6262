# SPDX-License-Identifier: Apache-2.0
"""The rate and the window of links that the test simulates, millisecond by millisecond."""

from collections import deque

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gateway.transport.link import (
    FIRST_WINDOW_BYTES,
    MIN_WINDOW_BYTES,
    QUEUE_S,
    Link,
    Reading,
)

STEP_NS = 1_000_000


class Simulation:
    """A link that drains so many bytes per second, and acknowledges them after its round trip."""

    def __init__(self, bytes_per_s: float, rtt_s: float = 0.0) -> None:
        self.link = Link()
        self.bytes_per_s = bytes_per_s
        self.rtt_s = rtt_s
        self.now_ns = 1_000_000_000
        self.written = self.acked = 0
        self.queued = 0.0  # before the slowest hop
        self._arriving: deque[tuple[int, float]] = deque()  # acknowledgements, and when
        self._acked = 0.0

    @property
    def on_the_way(self) -> int:
        return self.written - self.acked

    def write(self, size: int) -> None:
        self.written += size
        self.queued += size

    def step(self) -> None:
        self.now_ns += STEP_NS
        drained = min(self.queued, self.bytes_per_s * STEP_NS / 1e9)
        self.queued -= drained
        self._arriving.append((self.now_ns + round(self.rtt_s * 1e9), drained))
        while self._arriving and self._arriving[0][0] <= self.now_ns:
            self._acked += self._arriving.popleft()[1]
        self.acked = round(self._acked)

    def look(self) -> None:
        self.link.read(Reading(self.acked, self.on_the_way, self.rtt_s), self.now_ns)

    def run(self, seconds: float, *, frame: int = 0, every_ms: int = 1) -> None:
        """Let time pass. Write a frame every so often if the window has room for it."""
        for number in range(round(seconds * 1e9 / STEP_NS)):
            self.step()
            if not number % 5:
                self.look()
            while frame and not number % every_ms and self.on_the_way <= self.link.window_bytes:
                self.write(frame)
                if every_ms > 1:
                    break


@pytest.mark.parametrize("bytes_per_s", [20e3, 50e3, 250e3, 625e3, 2.5e6, 50e6])
@pytest.mark.parametrize("rtt_s", [0.0, 0.005, 0.05])
def test_the_rate_of_a_full_link_is_found(bytes_per_s: float, rtt_s: float):
    simulation = Simulation(bytes_per_s, rtt_s)
    simulation.run(4, frame=1000)
    assert simulation.link.bytes_per_s == pytest.approx(bytes_per_s, rel=0.2)


@pytest.mark.parametrize("bytes_per_s", [50e3, 250e3, 2.5e6])
@pytest.mark.parametrize("rtt_s", [0.0, 0.02])
def test_a_moment_of_the_rate_waits_before_a_full_link_and_it_is_never_idle(bytes_per_s, rtt_s):
    simulation = Simulation(bytes_per_s, rtt_s)
    simulation.run(3, frame=1000)
    before = simulation.acked
    simulation.run(2, frame=1000)
    assert simulation.acked - before == pytest.approx(2 * bytes_per_s, rel=0.1)
    assert simulation.queued <= max(1.5 * QUEUE_S * bytes_per_s, MIN_WINDOW_BYTES) + 1000


def test_a_link_that_becomes_bad_is_noticed_before_much_is_written():
    simulation = Simulation(2.5e6)
    simulation.run(3, frame=1000)
    simulation.bytes_per_s = 50e3
    simulation.run(0.3, frame=1000)
    assert simulation.link.bytes_per_s == pytest.approx(50e3, rel=0.3)
    written = simulation.written
    simulation.run(3, frame=1000)
    assert simulation.queued < 2 * MIN_WINDOW_BYTES
    assert simulation.written - written < 4 * 50e3


def test_a_link_at_less_than_half_of_its_rate_is_noticed_by_one_sample():
    simulation = Simulation(1e6)
    simulation.run(3, frame=1000)
    simulation.bytes_per_s = 450e3
    simulation.run(0.2, frame=1000)  # the second sample is the first of the new rate alone
    assert simulation.link.bytes_per_s == pytest.approx(450e3, rel=0.1)


def test_a_link_that_has_become_good_is_noticed_once_it_is_used():
    simulation = Simulation(50e3)
    simulation.run(3, frame=1000)
    simulation.bytes_per_s = 2.5e6
    simulation.run(2, frame=1000)
    assert simulation.link.bytes_per_s == pytest.approx(2.5e6, rel=0.2)


def test_the_rate_of_a_little_used_link_grows_until_it_is_forgotten():
    simulation = Simulation(50e3)
    simulation.run(3, frame=1000)
    simulation.bytes_per_s = 100e6
    simulation.run(1, frame=100, every_ms=20)  # the bytes on the way drain at once
    before = simulation.link.bytes_per_s
    simulation.run(1, frame=100, every_ms=20)
    after = simulation.link.bytes_per_s
    assert 1.5 <= after / before <= 1.7
    simulation.run(20, frame=100, every_ms=20)
    assert simulation.link.bytes_per_s is None
    assert simulation.link.window_bytes <= 4e6 * QUEUE_S + 1


def test_a_link_that_is_used_now_and_then_is_taken_for_faster_too():
    simulation = Simulation(30e3)
    simulation.run(3, frame=1000)
    simulation.bytes_per_s = 10e6
    for _ in range(20):
        simulation.run(0.2, frame=2000, every_ms=40)
        simulation.run(2)
    assert simulation.link.bytes_per_s is None


def test_of_a_link_that_was_never_full_nothing_is_known():
    simulation = Simulation(50e3)
    assert simulation.link.window_bytes == 64 * 1024
    for _ in range(50):
        simulation.run(0.1, frame=500, every_ms=20)
        assert simulation.link.bytes_per_s is None
    assert simulation.link.window_bytes >= FIRST_WINDOW_BYTES


@pytest.mark.parametrize("every_ms", [330, 1000])
def test_a_link_that_is_used_rarely_is_taken_for_faster_too(every_ms: int):
    simulation = Simulation(30e3)
    simulation.run(3, frame=1000)
    simulation.bytes_per_s = 10e6
    simulation.run(60, frame=2000, every_ms=every_ms)
    assert simulation.link.bytes_per_s is None


@pytest.mark.parametrize("bits_per_s", [24_000, 40_000])
def test_the_rate_of_a_link_that_passes_a_segment_now_and_then_is_found(bits_per_s: int):
    simulation = Simulation(0)
    for _ in range(60):
        simulation.queued = 0.0
        simulation.written += 1448
        took_ms = round(1448 * 8000 / bits_per_s)
        for number in range(took_ms):
            simulation.now_ns += STEP_NS
            if number == took_ms - 1:
                simulation.acked += 1448
            elif simulation.on_the_way < 3000:
                simulation.written += 1448
            simulation.look()
    assert simulation.link.bytes_per_s == pytest.approx(bits_per_s / 8, rel=0.3)


def test_a_hole_in_the_radio_is_not_a_slow_link():
    simulation = Simulation(625e3)
    simulation.run(3, frame=1000)
    known = simulation.link.bytes_per_s
    simulation.bytes_per_s = 0
    simulation.run(2, frame=1000)
    assert simulation.link.bytes_per_s == pytest.approx(known, rel=0.1)


def test_after_a_hole_the_rate_is_as_it_was():
    simulation = Simulation(625e3)
    simulation.run(3, frame=1000)
    simulation.bytes_per_s = 0
    simulation.run(1.9, frame=1000)
    simulation.bytes_per_s = 625e3
    for _ in range(30):
        simulation.run(0.01, frame=1000)
        assert simulation.link.bytes_per_s == pytest.approx(625e3, rel=0.2)


def test_a_quarter_of_a_second_without_a_byte_is_a_hole():
    simulation = Simulation(625e3)
    simulation.run(3, frame=1000)
    simulation.bytes_per_s = 0
    simulation.run(0.28, frame=1000)
    simulation.bytes_per_s = 625e3
    simulation.run(0.01, frame=1000)
    assert simulation.link.bytes_per_s == pytest.approx(625e3, rel=0.2)


def test_a_fifth_of_a_second_without_a_byte_is_a_slow_link():
    simulation = Simulation(625e3)
    simulation.run(3, frame=1000)
    simulation.bytes_per_s = 0
    simulation.run(0.2, frame=1000)
    simulation.bytes_per_s = 625e3
    simulation.run(0.01, frame=1000)
    assert simulation.link.bytes_per_s < 0.8 * 625e3


def test_a_link_that_is_uneven_has_its_mean_rate():
    simulation = Simulation(250e3)
    simulation.run(3, frame=1000)
    for number in range(40):
        simulation.bytes_per_s = 250e3 * (0.6 if number % 2 else 1.4)
        simulation.run(0.05, frame=1000)
        assert simulation.link.bytes_per_s == pytest.approx(250e3, rel=0.25)


def test_two_segments_may_be_on_the_way_however_slow_a_link():
    simulation = Simulation(10e3)
    simulation.run(4, frame=500)
    assert simulation.link.window_bytes == 3 * 1024


def test_a_burst_that_a_router_passes_on_at_once_at_most_doubles_the_rate():
    simulation = Simulation(50e3)
    simulation.run(3, frame=1000)
    simulation.queued = 0.0
    simulation._acked += simulation.on_the_way + 1_000_000  # at once
    simulation.written += 1_000_000
    known = simulation.link.bytes_per_s
    simulation.run(0.06)
    now = simulation.link.bytes_per_s
    assert now <= 2 * known


@given(
    st.lists(
        st.tuples(
            st.integers(0, 10**7),
            st.integers(0, 10**7),
            st.integers(0, 10**10),
            st.floats(0, 10),
        ),
        max_size=40,
    )
)
def test_the_window_lets_something_pass_with_any_reading(readings):
    link = Link()
    acked = now_ns = 0
    for drained, on_the_way, took_ns, rtt_s in readings:
        acked += drained
        now_ns += took_ns
        link.read(Reading(acked, on_the_way, rtt_s), now_ns)
        assert link.window_bytes >= MIN_WINDOW_BYTES
        assert link.bytes_per_s is None or link.bytes_per_s > 0
