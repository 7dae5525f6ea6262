# SPDX-License-Identifier: Apache-2.0
"""Robots come, go, and fail, one independent of another."""

import contextlib
from collections.abc import AsyncIterator
from types import SimpleNamespace
from typing import Any

import pytest

from gateway.errors import RosStartError
from gateway.relay import robots as module
from gateway.relay.robots import Robots
from tests.client import eventually


class Parts:
    """The servers of robots, without a network, and errors of robots that cannot be served."""

    def __init__(self) -> None:
        self.paths = SimpleNamespace(servers={})
        self.errors: dict[str, Exception] = {}
        self.opened: list[str] = []
        self.find_faults: dict[str, Any] = {}
        self.robots = Robots(self.open, self.paths, 2)

    @contextlib.asynccontextmanager
    async def open(self, name: str, find_faults: Any) -> AsyncIterator[Any]:
        if name in self.errors:
            raise self.errors[name]
        self.opened.append(name)
        self.find_faults[name] = find_faults
        server = SimpleNamespace(close_clients=self.close_clients)
        yield SimpleNamespace(server=server, router=SimpleNamespace(stop_robots=lambda: None))

    async def close_clients(self, reason: str) -> None:
        self.closed = reason

    @property
    def served(self) -> set[str]:
        return set(self.paths.servers)


@pytest.fixture
async def parts() -> AsyncIterator[Parts]:
    made = Parts()
    yield made
    await made.robots.close()
    assert not made.served


async def test_a_robot_that_comes_back_keeps_its_viewers(parts: Parts):
    assert module.KEPT_S == 60.0
    parts.robots.note("r1", True)
    await eventually(lambda: parts.served == {"r1"})
    parts.robots.note("r1", False)
    assert [fault.severity for fault in parts.find_faults["r1"]()] == ["not ready"]
    parts.robots.note("r1", True)
    assert not parts.find_faults["r1"]()
    assert parts.opened == ["r1"]


async def test_a_robot_that_stays_away_is_left_and_may_come_later(parts: Parts, monkeypatch):
    monkeypatch.setattr(module, "KEPT_S", 0.0)
    parts.robots.note("r1", True)
    await eventually(lambda: parts.served == {"r1"})
    parts.robots.note("r1", False)
    await eventually(lambda: not parts.served)
    assert parts.closed == "robot r1 is no longer connected"
    parts.robots.note("r1", True)  # perhaps before everything of it has ended
    await eventually(lambda: parts.served == {"r1"})


async def test_a_robot_without_room_is_served_when_another_has_gone(parts: Parts, monkeypatch):
    monkeypatch.setattr(module, "KEPT_S", 0.0)
    monkeypatch.setattr(module, "RETRY_S", 0.0)
    for name in ("r1", "r2", "r3", "r4"):
        parts.robots.note(name, True)
    await eventually(lambda: parts.served == {"r1", "r2"})
    assert [fault.severity for fault in parts.robots.faults()] == ["degraded"]
    parts.robots.note("r3", False)
    parts.robots.note("r1", False)
    await eventually(lambda: parts.served == {"r2", "r4"})
    assert not parts.robots.faults()


@pytest.mark.parametrize(
    ("error", "words"),
    [(RosStartError("no answer"), "no answer"), (ValueError("bug"), "internal error")],
)
async def test_a_robot_that_cannot_be_served_is_tried_again(
    parts: Parts, monkeypatch, error: Exception, words: str
):
    assert module.RETRY_S == 2.0
    monkeypatch.setattr(module, "RETRY_S", 0.01)
    parts.errors["r1"] = error
    for name in ("r1", "r2"):
        parts.robots.note(name, True)
    await eventually(lambda: parts.served == {"r2"} and bool(parts.robots.faults()))
    (fault,) = parts.robots.faults()
    assert words in fault.text
    del parts.errors["r1"]
    await eventually(lambda: parts.served == {"r1", "r2"})
    assert not parts.robots.faults()
