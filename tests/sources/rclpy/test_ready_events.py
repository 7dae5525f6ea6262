# SPDX-License-Identifier: Apache-2.0
"""Ready events: what it stands on, and what it leaves behind."""

import asyncio
import os
from typing import Any
from unittest.mock import Mock

import pytest

from gateway.sources.rclpy.ready_events import EventSource, ReadyEvents
from gateway.sources.source import RosError


class Entity:
    """Stands in for one of rcl's. Nothing is hooked."""


async def test_without_a_function_of_rcl_it_is_unsupported(monkeypatch):
    def no_library(name: str) -> None:
        raise OSError(f"{name}: cannot open shared object file")

    monkeypatch.setattr("ctypes.CDLL", no_library)
    with pytest.raises(RosError, match=r"librcl\.so"):
        ReadyEvents(asyncio.get_running_loop())


async def test_an_entity_that_cannot_be_created_leaves_no_descriptor() -> None:
    def refuse() -> None:
        raise RuntimeError("no entities today")

    loop = asyncio.get_running_loop()
    free = os.eventfd(0)
    os.close(free)
    ready_events = ReadyEvents(loop)
    with pytest.raises(RuntimeError, match="no entities today"):
        ready_events.open("client", refuse, lambda _: None, lambda: None)
    again = os.eventfd(0)
    os.close(again)
    assert again == free


class Callbacks:
    """Stands in for those of rcl: the test writes the eventfd itself."""

    fd = -1

    def count(self, kind: object, entity: object, fd: int) -> None:
        self.fd = fd

    def stop(self, kind: object, entity: object) -> None: ...


async def test_takes_are_counted_against_what_has_arrived_and_dds_can_have_kept() -> None:
    callbacks: Any = Callbacks()
    loop = asyncio.get_running_loop()
    source = EventSource(
        loop, callbacks, "client", Entity, lambda _: None, lambda: None, is_counted=True
    )
    assert not source.count_take()
    for _ in range(3):
        source.notify_again()  # which does not count as an arrival
    os.eventfd_write(callbacks.fd, 2)
    assert [source.count_take() for _ in range(4)] == [True, True, False, False]
    os.eventfd_write(callbacks.fd, 5000)
    assert [source.count_take() for _ in range(1025)] == [True] * 1024 + [False]
    source.close()


async def test_a_take_that_raises_is_not_repeated_for_nothing_new(monkeypatch):
    calls: list[None] = []
    raised = asyncio.Event()
    loop = asyncio.get_running_loop()
    loop.set_exception_handler(lambda *_: raised.set())
    ready_events = ReadyEvents(loop)
    monkeypatch.setattr(ready_events, "_hooks", Mock())

    def take() -> None:
        calls.append(None)
        raise RuntimeError("failed to take request")

    source = ready_events.open("service", Entity, lambda _: None, take)
    source.notify_again()
    await raised.wait()
    for _ in range(50):
        await asyncio.sleep(0)
    source.close()
    assert len(calls) == 1
