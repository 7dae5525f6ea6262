# SPDX-License-Identifier: Apache-2.0
"""An operator drives a robot all the time, and is killed, frozen and cut off in turns."""

import asyncio
import contextlib
import os
import signal
import time
from asyncio.subprocess import Process
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

from tests.e2e.faults import scene
from tests.e2e.faults.scene import Base, until, until_it_moves
from tests.soak.over import Over
from tests.soak.vitals import guard_of

DEADLINE_S: Final = 0.5
BETWEEN_S: Final = 6.0  # faults
REACTION_S: Final = 0.1  # beyond the deadline, where there is one
GIVEN_UP_S: Final = 60.0  # a robot that goes on for so long was not stopped
_QUIET_S: Final = 1.0  # a backlog of some seconds takes milliseconds
_KEPT: Final = 400  # commands heard: 20 s


@dataclass(frozen=True)
class Fault:
    """One fault, and what the robot heard."""

    name: str
    at_s: float
    took_s: float
    """Until the first zero came."""
    bound_s: float
    """Without what a busy machine takes: see docs/reference/reaction-times.md."""
    moved_again: bool = False
    """It moved before the stick was let go of."""


class Driving:
    """The operator at one link to the gateway."""

    def __init__(self, robot: Base, gateway_pid: int, cable: Process, url: str) -> None:
        self._robot = robot
        self._gateway_pid = gateway_pid
        self._cable = cable
        self._url = url
        self._stack = contextlib.AsyncExitStack()
        self._operator: Process | None = None
        self.faults: list[Fault] = []

    async def run(self, over: Over) -> None:
        """Inject faults, one after the other, until it is over. The robot stands then."""
        faults = [
            lambda: self._ends("client killed", signal.SIGKILL),
            lambda: self._ends("client closed", signal.SIGINT),
            self._frozen,
            lambda: self._black(1.5),
            self._guard_killed,
            lambda: self._black(4.0),
        ]
        number = 0
        try:
            while not await over.within(BETWEEN_S):
                fault = faults[number % len(faults)]
                number += 1
                if fault != self._guard_killed or over.may_kill:
                    await fault()
        finally:
            await self._stack.aclose()

    async def _moving(self) -> Process:
        if self._operator is None:
            self._operator = await self._stack.enter_async_context(scene.operator(self._url))
        del self._robot.heard[:-_KEPT]
        while True:
            await until_it_moves(self._robot, self._operator)
            if self._robot.zero_after(time.monotonic_ns() - 200_000_000) is None:
                return self._operator

    async def _injected(
        self, name: str, inject: Callable[[], object], deadline_s: float
    ) -> tuple[Fault, int]:
        before_ns = time.monotonic_ns()
        inject()
        with contextlib.suppress(TimeoutError):
            await until(lambda: self._robot.zero_after(before_ns) is not None, GIVEN_UP_S)
        zero_ns = self._robot.zero_after(before_ns)
        took_s = ((zero_ns or time.monotonic_ns()) - before_ns) / 1e9
        fault = Fault(name, before_ns / 1e9, took_s, deadline_s + REACTION_S)
        return fault, zero_ns or before_ns

    async def _ends(self, name: str, number: signal.Signals) -> None:
        operator = await self._moving()
        fault, _ = await self._injected(name, lambda: operator.send_signal(number), 0.0)
        self.faults.append(fault)
        self._operator = None
        await operator.wait()

    async def _frozen(self) -> None:
        operator = await self._moving()
        await self._silenced("client frozen", operator, 1.5)

    async def _black(self, dark_s: float) -> None:
        await self._moving()
        await self._silenced(f"link black for {dark_s:g} s", self._cable, dark_s)

    async def _silenced(self, name: str, process: Process, dark_s: float) -> None:
        def stop() -> None:
            process.send_signal(signal.SIGSTOP)

        try:
            fault, zero_ns = await self._injected(name, stop, DEADLINE_S)
            await asyncio.sleep(max(dark_s + fault.at_s - time.monotonic(), 0.1))
        finally:
            process.send_signal(signal.SIGCONT)
        # the operator pushes all the time. Nothing of it may come, old or new
        await asyncio.sleep(_QUIET_S)
        moved_again = bool(self._robot.moved_after(zero_ns))
        self.faults.append(replace(fault, moved_again=moved_again))

    async def _guard_killed(self) -> None:
        await self._moving()

        def kill() -> None:
            for guard in guard_of(self._gateway_pid):
                os.kill(guard, signal.SIGKILL)

        fault, _ = await self._injected("guard killed", kill, 0.0)
        self.faults.append(fault)
