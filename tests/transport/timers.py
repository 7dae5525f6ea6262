# SPDX-License-Identifier: Apache-2.0
"""A clock and the timers of a loop, both in the test's hand."""

from collections.abc import Callable
from functools import partial
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest


class Handle:
    """A call that is due at some time."""

    def __init__(self, due_s: float, call: Callable[[], None]) -> None:
        self.due_s = due_s
        self.call = call
        self.is_cancelled = False

    def cancel(self) -> None:
        self.is_cancelled = True


class Timers:
    """The time, and the timers. Only `pass_time` and `next_turn` advance it."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, *modules: ModuleType) -> None:
        self.now_s = 1000.0
        self.handles: list[Handle] = []
        clock = SimpleNamespace(
            monotonic=lambda: self.now_s, monotonic_ns=lambda: round(self.now_s * 1e9)
        )
        loop = SimpleNamespace(call_later=self._call_later, call_soon=partial(self._call_later, 0))
        for module in modules:
            monkeypatch.setattr(module, "time", clock)
            monkeypatch.setattr(module, "asyncio", SimpleNamespace(get_running_loop=lambda: loop))

    def take(self, seconds: float) -> None:
        """Let something take so long. Nothing else happens at the same time."""
        self.now_s += seconds

    def next_turn(self) -> float:
        """Do what is due next, at its time. Return how long that was to wait for."""
        handle = min(self.handles, key=lambda handle: handle.due_s)
        self.handles.remove(handle)
        wait_s = max(0.0, handle.due_s - self.now_s)
        self.now_s += wait_s
        if not handle.is_cancelled:
            handle.call()
        return wait_s

    def run(self, seconds: float) -> None:
        """Do what is due within some seconds."""
        end_s = self.now_s + seconds
        while any(handle.due_s <= end_s for handle in self.handles):
            self.next_turn()
        self.now_s = max(self.now_s, end_s)

    def _call_later(self, delay_s: float, call: Callable[..., None], *arguments: Any) -> Handle:
        self.handles.append(Handle(self.now_s + delay_s, partial(call, *arguments)))
        return self.handles[-1]
