# SPDX-License-Identifier: Apache-2.0
"""The time of the event loop that clients may take, each and all of one address together.

It is wall time, not CPU time, because others lose it even on a busy machine or while ROS blocks.
Reading the clock takes 80 ns, that of a thread's CPU time ten times as long.
"""

import asyncio
import math
import time
from collections.abc import Callable, Iterator
from typing import Final

from gateway.transport.turns import Turns

WINDOW_S: Final = 1.0  # the unspent time of this window may be spent at once
REFILL_S: Final = 0.004  # a turn, before a wait ends: else there would be one for each read
SETTLE_S: Final = 0.0005  # no sooner: most frames take 20 us, and two budgets would add another
ROUNDING_S: Final = 1e-6  # otherwise a wait could end slightly too soon, with nothing left
MAX_ADDRESSES: Final = 1024  # that are remembered, 0.3 MB, in addition to those with connections


class TimeBudget:
    """A share of all time, which is spent beforehand and refilled as time passes."""

    __slots__ = ("_last_s", "_left_s", "_most_s", "_share")

    def __init__(self, share: float, now_s: float) -> None:
        self._share = share
        # the whole share means no limit, because clocks and estimates differ by microseconds
        self._most_s = self._left_s = share * WINDOW_S if share < 1 else math.inf
        self._last_s = now_s

    def left_s(self, now_s: float) -> float:
        """Return the seconds that may be spent. A negative number is a debt."""
        earned_s = (now_s - self._last_s) * self._share
        self._last_s = now_s
        self._left_s = min(self._most_s, self._left_s + earned_s)
        return self._left_s

    def spend(self, spent_s: float, now_s: float) -> float:
        """Take away what was spent, which may be more than is left. Return what is left."""
        self._left_s = self.left_s(now_s) - spent_s
        return self._left_s

    def limit(self, left_s: float) -> None:
        """Leave no more than *left_s*."""
        self._left_s = min(self._left_s, left_s)

    def wait_s(self, now_s: float) -> float:
        """Return how long it takes until a slice is left. 0 if something is."""
        debt_s = -self.left_s(now_s)
        return (debt_s + REFILL_S) / self._share if debt_s > ROUNDING_S else 0.0

    def is_half_full(self, now_s: float) -> bool:
        """Return whether little was spent lately."""
        return self.left_s(now_s) >= self._most_s / 2

    def is_full(self, now_s: float) -> bool:
        """Return whether nothing was spent lately: a new budget would be the same."""
        return self.left_s(now_s) >= self._most_s


class AddressBudget:
    """The time of all connections of one address.

    Waiting connections go on one at a time, first the one that has spent least. So a greedy
    connection delays the others of its address only by one slice, not by all of its debts.
    """

    def __init__(self, share: float, now_s: float) -> None:
        self.time = TimeBudget(share, now_s)
        self.users = 0
        self.spent_s = 0.0
        self.pauses = 0
        self._waiting: list[Spending] = []
        self._timer: asyncio.TimerHandle | None = None

    def wait(self, spending: "Spending") -> None:
        """Let *spending* go on when its turn has come."""
        self._waiting.append(spending)
        self._set_timer()

    def forget(self, spending: "Spending") -> None:
        """End the wait of a connection that is gone."""
        if spending in self._waiting:
            self._waiting.remove(spending)

    def _set_timer(self) -> None:
        if self._timer is None and self._waiting:
            loop = asyncio.get_running_loop()
            self._timer = loop.call_later(self.time.wait_s(time.monotonic()), self._refilled)

    def _refilled(self) -> None:
        self._timer = None
        now_s = time.monotonic()
        if self.time.wait_s(now_s) == 0 and self._waiting:
            thriftiest = max(self._waiting, key=lambda spending: spending.own.left_s(now_s))
            self._waiting.remove(thriftiest)
            thriftiest.go_on()
        self._set_timer()


class Spending:
    """The account of one connection, with its own budget and with its address's."""

    def __init__(self, budgets: "TimeBudgets", address: str, share: float) -> None:
        now_s = time.monotonic()
        self.own = TimeBudget(share, now_s)
        self.turns = budgets.turns
        self.go_on: Callable[[], None] = lambda: None  # of the wait at hand
        self.spent_s = 0.0
        self.pauses = 0
        self._budgets = budgets
        self._address = budgets.join(address)
        # otherwise a client that connects again would have another burst
        self.own.limit(self._address.time.left_s(now_s))
        self._timer: asyncio.TimerHandle | None = None
        self._unsettled_s = 0.0
        self.is_in_debt = self._is_over = self.own.left_s(now_s) < 0

    def move(self, address: str) -> None:
        """Belong to another address from now on: a proxy has named the client's."""
        self._address.users -= 1
        self._address = self._budgets.join(address)

    def spend(self, spent_s: float, now_s: float) -> bool:
        """Take away what this connection has spent. Return whether something is left."""
        self._unsettled_s += spent_s
        if self._unsettled_s < SETTLE_S and not self._is_over:
            return True
        return self._settle(now_s)

    def wait(self, go_on: Callable[[], None]) -> None:
        """Call *go_on* once both budgets have something left."""
        self.go_on = go_on
        self._budgets.pauses += 1
        self._address.pauses += 1
        self.pauses += 1
        wait_s = self.own.wait_s(time.monotonic())
        if wait_s > 0:
            loop = asyncio.get_running_loop()
            self._timer = loop.call_later(wait_s, self._address.wait, self)
        else:
            self._address.wait(self)

    def stop_waiting(self) -> None:
        """End a wait: one of the budgets does not matter any more."""
        if self._timer is not None:
            self._timer.cancel()
        self._address.forget(self)

    def close(self, spent_s: float = 0.0) -> None:
        """Take away what the end has taken, and end a wait. The address pays on."""
        self._unsettled_s += spent_s
        self._settle(time.monotonic())
        self.stop_waiting()
        self._address.users -= 1

    def _settle(self, now_s: float) -> bool:
        spent_s, self._unsettled_s = self._unsettled_s, 0.0
        self._budgets.spent_s += spent_s
        self._address.spent_s += spent_s
        self.spent_s += spent_s
        self.is_in_debt = self.own.spend(spent_s, now_s) < 0
        self._is_over = self._address.time.spend(spent_s, now_s) < 0 or self.is_in_debt
        return not self._is_over


class TimeBudgets:
    """The budgets of all addresses. They outlive the connections until they are full again."""

    def __init__(self, client_share: float, address_share: float) -> None:
        self.turns = Turns()
        self.spent_s = 0.0
        self.pauses = 0
        self._client_share = client_share
        self._address_share = address_share
        self._addresses: dict[str, AddressBudget] = {}

    def in_use(self) -> Iterator[tuple[str, AddressBudget]]:
        """Yield the addresses that have connections."""
        return ((address, each) for address, each in self._addresses.items() if each.users)

    def open(self, address: str) -> Spending:
        """Return the budgets of a new connection."""
        return Spending(self, address, self._client_share)

    def join(self, address: str) -> AddressBudget:
        """Return the budget of an address, with one user more."""
        budget = self._addresses.get(address)
        if budget is None:
            if len(self._addresses) >= MAX_ADDRESSES:
                self._forget_one()
            budget = AddressBudget(self._address_share, time.monotonic())
            self._addresses[address] = budget
        budget.users += 1
        return budget

    def expire(self, now_s: float) -> None:
        """Forget the addresses without connections whose budgets are full again."""
        for address, budget in list(self._addresses.items()):
            if not budget.users and budget.time.is_full(now_s):
                del self._addresses[address]

    def _forget_one(self) -> None:
        """Forget the address without connections that is known longest, if there is one."""
        for address, budget in self._addresses.items():
            if not budget.users:
                del self._addresses[address]
                return
