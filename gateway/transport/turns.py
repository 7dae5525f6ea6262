# SPDX-License-Identifier: Apache-2.0
"""The order in which clients have their input handled, and the time of all in one turn of the loop.

All sockets are read first, and then their input is handled here. So the kernel's order of sockets
does not matter. A client that drives comes first, then clients that have spent little time.
"""

import asyncio
import time
from typing import Final, Protocol

# Of all clients together, then ROS, answers and new input have theirs: a tenth of what people
# notice in a hand. Nobody waits longer for a `stop` than two of them, and one operation.
TURN_S: Final = 0.004


class Waiting(Protocol):
    """The input of a client."""

    def rank(self, now_s: float) -> int:
        """Return 0 of a client that goes first, and more of one that may wait."""

    def work(self, end_s: float) -> None:
        """Handle some of it until a time, and at least one operation."""


class Turns:
    """The clients with input to handle, in the order of their turns."""

    def __init__(self) -> None:
        self._ready: dict[Waiting, None] = {}  # the one that has waited longest is first
        self._is_due = False

    def add(self, client: Waiting) -> None:
        """Give a client its turn, in this turn of the event loop if it can still begin."""
        self._ready[client] = None
        if not self._is_due:
            self._is_due = True
            asyncio.get_running_loop().call_soon(self._run)

    def _run(self) -> None:
        self._is_due = False
        ready, self._ready = self._ready, {}
        now_s = time.monotonic()
        end_s = now_s + TURN_S
        order = list(ready)
        if len(order) > 1:
            order.sort(key=lambda client: client.rank(now_s))
        for served, client in enumerate(order):
            if now_s > end_s:
                self._ready = dict.fromkeys(order[served:]) | self._ready
                break
            # time that one client does not need is left to the next
            client.work(now_s + (end_s - now_s) / (len(order) - served))
            now_s = time.monotonic()
        if self._ready and not self._is_due:
            self._is_due = True
            asyncio.get_running_loop().call_soon(self._run)
