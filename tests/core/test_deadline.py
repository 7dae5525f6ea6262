# SPDX-License-Identifier: Apache-2.0
import asyncio

import pytest

from gateway.core.deadline import Deadline
from gateway.core.errors import ProtocolError
from tests.clock import StoppedClock


async def test_a_step_that_misses_the_deadline_is_cancelled_and_named():
    deadline = Deadline.within(0.01)
    with pytest.raises(ProtocolError, match=r"^the robot has not answered within 0\.01 s$") as late:
        async with deadline.limit("the robot has not answered"):
            await asyncio.get_running_loop().create_future()
    assert late.value.code == "timeout"


async def test_a_second_step_does_not_restart_the_time():
    deadline = Deadline.within(0.01)
    for _ in range(2):  # the second has no time left at all
        with pytest.raises(ProtocolError, match=r"within 0\.01 s"):
            async with deadline.limit("nobody has answered"):
                await asyncio.get_running_loop().create_future()


async def test_a_later_step_has_the_time_that_is_left(monkeypatch: pytest.MonkeyPatch):
    clock = StoppedClock(monkeypatch)
    deadline = Deadline.within(5)
    await clock.advance(4)

    async def wait() -> None:
        async with deadline.limit("nobody has answered"):
            await asyncio.get_running_loop().create_future()

    waiting = asyncio.ensure_future(wait())
    await clock.advance(0.99)
    assert not waiting.done()
    await clock.advance(0.02)
    assert waiting.done()
    with pytest.raises(ProtocolError, match="within 5 s"):
        await waiting


async def test_a_step_within_the_deadline_is_not_disturbed():
    async with Deadline.within(60).limit("nobody has answered"):
        await asyncio.sleep(0)
