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


@pytest.mark.parametrize("holds_hz", [1000, 1001, 1999, 4321, 70_000, 999, 400, 20, 0])
def test_the_highest_rate_is_found_to_ten_per_cent_and_held_in_the_last_run(holds_hz):
    machine = Machine(holds_hz)
    found = search(machine)
    assert holds_hz / 1.1 <= found.rate_hz <= holds_hz
    assert not found.is_senders_limit
    if found.rate_hz:
        assert machine.runs[-1] == found.rate_hz
        assert machine.runs.count(found.rate_hz) == 2


@pytest.mark.parametrize(
    ("holds_hz", "sends_hz", "is_senders_limit"),
    [(1e9, 5000, True), (1e9, 490, True), (3000, 3500, False)],
)
def test_the_limit_that_was_met_last_is_the_senders_or_the_receivers(
    holds_hz, sends_hz, is_senders_limit
):
    found = search(Machine(holds_hz, sends_hz))
    assert min(holds_hz, sends_hz) / 1.1 <= found.rate_hz <= min(holds_hz, sends_hz)
    assert found.is_senders_limit == str(found).startswith(">= ") == is_senders_limit


def test_a_rate_that_is_not_confirmed_is_stepped_down_from():
    lucky, machine = Machine(2000), Machine(1500)
    found = highest_rate(lucky, machine, 1000)
    assert 1500 * 0.9 <= found.rate_hz <= 1500
    assert machine.runs[-1] == found.rate_hz
