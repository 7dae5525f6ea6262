# SPDX-License-Identifier: Apache-2.0
"""Opening, and giving it up."""

import asyncio
import threading
from collections.abc import Callable
from pathlib import Path

import pytest

from gateway.sources.recording import opening
from gateway.sources.recording.errors import RecordingError
from gateway.sources.recording.recording import Recording
from tests.client import eventually


async def test_a_recording_opened_for_nobody_is_closed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    begun, goes_on, is_closed = threading.Event(), threading.Event(), threading.Event()

    class Opened(Recording):
        def close(self) -> None:
            is_closed.set()

    def wait(*_: object) -> Recording:
        begun.set()
        goes_on.wait()
        return Opened(())

    monkeypatch.setattr(opening, "open_recording", wait)
    task = asyncio.create_task(opening.opened([Path("x")]))
    await eventually(begun.is_set)
    task.cancel()
    with pytest.raises(asyncio.CancelledError):
        await task  # although the thread still waits
    goes_on.set()
    await eventually(is_closed.is_set)


async def test_reading_for_nobody_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    ended = threading.Event()

    def read(_: object, __: object, show: Callable[[str], object]) -> Recording:
        try:
            while True:
                show("some of it is read")
        except RecordingError:
            ended.set()
            raise

    monkeypatch.setattr(opening, "open_recording", read)
    task = asyncio.create_task(opening.opened([Path("x")]))
    await asyncio.sleep(0)
    task.cancel()
    await eventually(ended.is_set)
