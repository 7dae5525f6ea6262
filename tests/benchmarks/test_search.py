# SPDX-License-Identifier: Apache-2.0
"""The search finds the highest rate held, and says when the sender was the limit."""

import pytest

from benchmarks.search import Outcome, highest_rate


class Machine:
    """Holds up to one rate. Its sender reaches another."""

    def __init__(self, holds_hz, sends_hz=1e9):
        self.holds_hz = holds_hz
        self.sends_hz = sends_hz
        self.runs = []

    def __call__(self, rate_hz):
        self.runs.append(rate_hz)
        if rate_hz > self.sends_hz:
            return Outcome.NOT_SENT
        return Outcome.HELD if rate_hz <= self.holds_hz else Outcome.LOST


def search(hold):
    return highest_rate(hold, hold, 1000)


@pytest.mark.parametrize("holds_hz", [1000, 1001, 1999, 2000, 4321, 70_000])
def test_the_highest_rate_is_found_to_ten_per_cent(holds_hz):
    found = search(Machine(holds_hz))
    assert holds_hz / 1.1 <= found.rate_hz <= holds_hz
    assert not found.is_senders_limit


@pytest.mark.parametrize("holds_hz", [999, 400, 20])
def test_it_lies_below_the_start_where_that_is_not_held(holds_hz):
    found = search(Machine(holds_hz))
    assert holds_hz / 1.1 <= found.rate_hz <= holds_hz


def test_the_senders_limit_is_told_from_the_receivers():
    found = search(Machine(holds_hz=1e9, sends_hz=5000))
    assert 5000 / 1.1 <= found.rate_hz <= 5000
    assert found.is_senders_limit
    assert str(found).startswith(">= ")


def test_the_senders_limit_is_told_below_the_start_too():
    assert search(Machine(holds_hz=1e9, sends_hz=490)).is_senders_limit


def test_the_limit_is_the_one_that_was_met_last():
    found = search(Machine(holds_hz=3000, sends_hz=3500))
    assert not found.is_senders_limit


def test_a_receiver_that_holds_nothing_gets_nothing():
    found = search(Machine(0))
    assert found.rate_hz == 0
    assert not found.is_senders_limit


def test_the_rate_found_was_held_in_the_last_run():
    machine = Machine(3000)
    found = search(machine)
    assert machine.runs[-1] == found.rate_hz
    assert machine.runs.count(found.rate_hz) == 2


def test_a_rate_that_is_not_confirmed_is_stepped_down_from():
    lucky, machine = Machine(2000), Machine(1500)
    found = highest_rate(lucky, machine, 1000)
    assert 1500 * 0.9 <= found.rate_hz <= 1500
    assert machine.runs[-1] == found.rate_hz
