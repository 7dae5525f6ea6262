# SPDX-License-Identifier: Apache-2.0
"""Turns, with the clock and the timers in the test's hand."""

import pytest

from gateway.transport import turns as turns_module
from gateway.transport.turns import Turns
from tests.transport.timers import Timers


class Client:
    """A client with some operations that wait, of *cost_s* each."""

    def __init__(  # the properties of a client
        self,
        turns: Turns,
        clock: Timers,
        log: list[str],
        name: str,
        rank: int,
        count: int,
        cost_s: float,
    ) -> None:
        self._turns = turns
        self._clock = clock
        self._log = log
        self._name = name
        self._rank = rank
        self._cost_s = cost_s
        self.left = count

    def rank(self, now_s: float) -> int:
        return self._rank

    def work(self, end_s: float) -> None:
        while self.left:
            self.left -= 1
            self._log.append(self._name)
            self._clock.take(self._cost_s)
            if self._clock.now_s > end_s:
                break
        if self.left:
            self._turns.add(self)


class Room:
    """A loop with clients."""

    def __init__(self, clock: Timers) -> None:
        self._clock = clock
        self._turns = Turns()
        self.log: list[str] = []

    def ready(self, name: str, rank: int = 2, count: int = 1000, cost_s: float = 0.0001) -> None:
        self._turns.add(Client(self._turns, self._clock, self.log, name, rank, count, cost_s))

    def turn(self) -> list[str]:
        """Return who had its turn in the next turn of the loop, in that order."""
        self.log.clear()
        self._clock.next_turn()
        return list(dict.fromkeys(self.log))


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Timers:
    return Timers(monkeypatch, turns_module)


def test_in_each_turn_the_driver_is_first_and_the_thriftiest_client_next(clock: Timers):
    room = Room(clock)
    for name in "abcdefgh":
        room.ready(name)
    for _ in range(5):
        room.ready("light", 1, count=1)
        room.ready("driver", 0, count=1)
        assert room.turn()[:2] == ["driver", "light"]


@pytest.mark.parametrize("clients", [1, 8, 100])
def test_all_clients_together_have_4_ms_of_a_turn(clock: Timers, clients: int):
    room = Room(clock)
    for number in range(clients):
        room.ready(str(number))
    for _ in range(10):
        start_s = clock.now_s
        room.turn()
        assert clock.now_s - start_s == pytest.approx(0.004, abs=0.0003)


def test_a_turn_is_over_after_the_operation_that_exceeds_it_and_the_others_are_first_in_the_next(
    clock: Timers,
):
    room = Room(clock)
    for name in "abc":
        room.ready(name, cost_s=0.003)
    assert [room.turn() for _ in range(3)] == [["a", "b"], ["c", "a"], ["b", "c"]]


def test_clients_of_one_rank_have_as_much_of_a_turn(clock: Timers):
    room = Room(clock)
    for name in "abcd":
        room.ready(name)
    room.turn()
    assert all(room.log.count(name) == pytest.approx(10, abs=1) for name in "abcd")


def test_unused_time_goes_to_the_others(clock: Timers):
    room = Room(clock)
    for name in "abc":
        room.ready(name, count=1)
    room.ready("d")
    room.turn()
    assert room.log.count("d") == pytest.approx(37, abs=1)


def test_without_ready_clients_there_are_no_turns(clock: Timers):
    room = Room(clock)
    room.ready("a", count=1)
    room.turn()
    assert not clock.handles
