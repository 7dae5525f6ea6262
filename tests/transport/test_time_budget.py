# SPDX-License-Identifier: Apache-2.0
"""Time budgets, with the clock and the timers in the test's hand."""

from functools import partial

import pytest

from gateway.transport import time_budget
from gateway.transport.time_budget import Spending, TimeBudget, TimeBudgets
from tests.transport.timers import Timers


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Timers:
    return Timers(monkeypatch, time_budget)


def wait_greedily(spending: Spending, clock: Timers, order: list[str], name: str) -> None:
    """Have a connection spend 10 ms whenever it may, and note it."""

    def go_on() -> None:
        order.append(name)
        spending.spend(0.01, clock.now_s)
        spending.wait(go_on)

    spending.wait(go_on)


def test_the_unspent_time_of_a_second_may_be_spent_at_once_and_no_more():
    budget = TimeBudget(0.25, 100)
    assert budget.left_s(200) == 0.25
    assert budget.spend(0.35, 200) == pytest.approx(-0.1)
    assert budget.wait_s(200) == pytest.approx(0.416)
    assert budget.left_s(200.416) == pytest.approx(0.004)
    assert not budget.is_full(201.3)
    assert budget.is_full(201.5)


def test_a_debt_of_less_than_a_microsecond_does_not_count():
    budget = TimeBudget(0.25, 100)
    budget.spend(0.25 + 0.5e-6, 100)
    assert budget.wait_s(100) == 0
    budget.spend(1e-6, 100)
    assert budget.wait_s(100) > 0


def test_the_whole_time_means_no_limit():
    budget = TimeBudget(1, 100)
    assert budget.spend(1000, 100) > 0
    assert budget.wait_s(100) == 0


def test_connections_of_one_address_share_a_budget_and_go_on_one_at_a_time(clock: Timers):
    budgets = TimeBudgets(0.25, 0.5)
    order: list[str] = []
    pair = [budgets.open("10.0.0.1") for _ in "ab"]
    for spending in pair:
        assert spending.spend(0.24, clock.now_s)
    assert not pair[0].spend(0.03, clock.now_s)
    for spending, name in zip(pair, "ab", strict=True):
        wait_greedily(spending, clock, order, name)
    clock.run(2)
    assert len(order) == pytest.approx(2 * 0.5 / 0.01, rel=0.05)  # half of the time
    assert order.count("a") == pytest.approx(len(order) / 2, rel=0.1)
    for spending in pair:
        spending.close()


def test_the_waiting_client_that_has_spent_least_goes_first(clock: Timers):
    budgets = TimeBudgets(0.25, 0.5)
    order: list[str] = []
    pair = [budgets.open("10.0.0.1") for _ in "ab"]
    modest = budgets.open("10.0.0.1")
    for spending in pair:
        spending.spend(0.24, clock.now_s)
    modest.spend(0.03, clock.now_s)
    for spending, name in ((pair[0], "a"), (pair[1], "b"), (modest, "modest")):
        wait_greedily(spending, clock, order, name)
    assert order == []
    while not order:
        clock.next_turn()
    assert order == ["modest"]
    for spending in (*pair, modest):
        spending.close()


def test_an_address_does_not_delay_another(clock: Timers):
    budgets = TimeBudgets(0.25, 0.5)
    one, other = budgets.open("10.0.0.1"), budgets.open("10.0.0.2")
    one.spend(100, clock.now_s)
    assert other.spend(0.1, clock.now_s)


def test_a_new_connection_has_no_more_than_its_address(clock: Timers):
    budgets = TimeBudgets(0.25, 0.5)
    first = budgets.open("10.0.0.1")
    first.spend(0.4, clock.now_s)
    first.close()
    again = budgets.open("10.0.0.1")
    assert again.own.left_s(clock.now_s) == pytest.approx(0.1)


def test_a_client_behind_a_proxy_spends_the_time_of_its_address(clock: Timers):
    budgets = TimeBudgets(0.25, 0.5)
    client = budgets.open("10.0.0.1")
    client.move("192.0.2.7")
    client.spend(100, clock.now_s)
    assert budgets.open("10.0.0.1").spend(0.1, clock.now_s)
    assert not budgets.open("192.0.2.7").spend(0.1, clock.now_s)


def test_a_connection_that_is_gone_waits_no_longer(clock: Timers):
    budgets = TimeBudgets(0.25, 0.5)
    order: list[str] = []
    gone = [budgets.open("10.0.0.1") for _ in "ab"]
    gone[0].spend(0.3, clock.now_s)  # waits for its own budget, then for that of the address
    gone[0].wait(partial(order.append, "a"))
    gone[1].spend(0.22, clock.now_s)
    gone[1].wait(partial(order.append, "b"))
    for spending in gone:
        spending.close()
    clock.run(10)
    assert order == []


def test_budgets_outlive_connections_until_they_are_full_again(clock: Timers):
    budgets = TimeBudgets(0.25, 0.5)
    client = budgets.open("10.0.0.1")
    client.spend(0.4, clock.now_s)
    budgets.expire(clock.now_s + 5)
    client.close()
    client.spend(0.1, clock.now_s)  # its tasks, say
    budgets.expire(clock.now_s + 0.9)
    assert len(budgets._addresses) == 1
    budgets.expire(clock.now_s + 1)
    assert not budgets._addresses


def test_so_many_addresses_are_remembered_and_those_of_connections_always(clock: Timers):
    budgets = TimeBudgets(0.25, 0.5)
    stays = budgets.open("stays")
    for number in range(2000):
        passes = budgets.open(f"10.0.{number // 256}.{number % 256}")
        passes.spend(0.1, clock.now_s)
        passes.close()
    assert len(budgets._addresses) == 1024
    assert "stays" in budgets._addresses
    assert "10.0.7.207" in budgets._addresses
    stays.close()


def test_small_sums_add_up(clock: Timers):
    budgets = TimeBudgets(0.25, 0.5)
    client = budgets.open("10.0.0.1")
    times = 0
    while client.spend(0.0001, clock.now_s):
        times += 1
    assert times == pytest.approx(2500, abs=6)
    client.spend(0.0001, clock.now_s)
    client.close()
    assert budgets.spent_s == pytest.approx((times + 2) * 0.0001)


def test_spent_times_and_waits_are_counted(clock: Timers):
    budgets = TimeBudgets(0.25, 0.5)
    client = budgets.open("10.0.0.1")
    client.spend(0.3, clock.now_s)
    client.wait(lambda: None)
    assert (budgets.spent_s, budgets.pauses) == (0.3, 1)
    client.close()
