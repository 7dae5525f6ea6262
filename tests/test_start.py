# SPDX-License-Identifier: Apache-2.0
"""When a start is over, by the state of the command topics and the clock."""

import asyncio
import contextlib
from dataclasses import dataclass

import pytest

from gateway import start as start_module
from gateway.metrics.state import ControlState
from gateway.start import Start
from tests.clock import StoppedClock
from tests.metrics.states import DRIVE

ROBOT = DRIVE._replace(listeners=1, is_guarded=True)
UNGUARDED = ROBOT._replace(is_guarded=False)
NOBODY = UNGUARDED._replace(listeners=0)


@dataclass
class Gateway:
    """The state that a start sees."""

    state: ControlState

    def control(self) -> ControlState:
        return self.state


@pytest.fixture
async def clock(monkeypatch: pytest.MonkeyPatch) -> StoppedClock:
    clock, loop = StoppedClock(monkeypatch), asyncio.get_running_loop()
    monkeypatch.setattr(start_module, "time", type("T", (), {"monotonic": staticmethod(loop.time)}))
    return clock


@pytest.mark.parametrize(
    ("state", "is_starting"),
    [
        (ControlState((), False, 0), False),  # nothing moves a robot here
        (ControlState((NOBODY,), False, 0), True),
        (ControlState((UNGUARDED,), True, 0), True),
        (ControlState((NOBODY, UNGUARDED), True, 0), True),
        (ControlState((UNGUARDED, ROBOT), True, 0), False),
        (ControlState((UNGUARDED,), False, 1), False),  # lost, which is a separate fault
        (ControlState((UNGUARDED,), True, 1), True),
    ],
)
async def test_a_gateway_starts_until_a_robot_can_be_driven(
    clock: StoppedClock, state: ControlState, *, is_starting: bool
):
    start = Start(Gateway(state).control)
    await clock.advance(100)
    assert [fault.severity for fault in start.faults()] == ["starting"] * is_starting


async def test_without_a_robot_the_start_is_over_after_5_s(clock: StoppedClock):
    start = Start(Gateway(ControlState((NOBODY,), True, 0)).control)
    await clock.advance(4.9)
    assert start.faults()
    await clock.advance(0.2)
    assert not start.faults()


async def test_people_are_invited_once_a_robot_can_be_driven_and_after_30_s_in_any_case(
    clock: StoppedClock,
):
    for ready_s, invited_s in ((3.0, 3.1), (100.0, 30.2)):
        gateway = Gateway(ControlState((UNGUARDED,), True, 0))
        invited: list[float] = []
        began_s = clock.now_s
        start = Start(gateway.control)
        with start.inviting(lambda told=invited, s=began_s: told.append(clock.now_s - s)):
            for _ in range(29):
                await clock.advance(min(ready_s, 29.9) / 29)
            assert invited == []
            if ready_s < 30:
                gateway.state = ControlState((ROBOT,), True, 0)
            for _ in range(4):
                await clock.advance(0.06)
            assert [each <= invited_s for each in invited] == [True]
            await clock.advance(50)
        assert len(invited) == 1


async def test_a_gateway_that_ends_does_not_invite(clock: StoppedClock):
    invited: list[object] = []
    with contextlib.suppress(KeyError):
        start = Start(Gateway(ControlState((UNGUARDED,), True, 0)).control)
        with start.inviting(lambda: invited.append(None)):
            await clock.advance(1)
            raise KeyError
    await clock.advance(100)
    assert invited == []
