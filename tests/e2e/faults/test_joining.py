# SPDX-License-Identifier: Apache-2.0
"""A robot that starts again during a push: it stands, then drives, and the gateway dies.

None, one or three others listen to the same topic. With ``FAULTS_BUSY=8``, that many busy loops
run at the same time.
"""

import asyncio
import contextlib
import json
import signal
import time
from collections.abc import AsyncIterator

import pytest
from websockets.asyncio.client import ClientConnection, connect

from tests.e2e.faults import scene
from tests.e2e.faults.conftest import BUSY, IS_MEASURED, REPEAT
from tests.e2e.faults.processes import guard_of, is_running
from tests.e2e.faults.scene import Base, until

pytestmark = [pytest.mark.asyncio, pytest.mark.timeout(3600)]

TRIALS, OTHERS = (REPEAT, (0, 1, 3)) if IS_MEASURED else (1, (1,))
PERIOD_S = 0.05
LATEST_KILL_S = 0.2  # after the first command that the robot hears
LET_GO_S = 0.26  # then the latch is reset
STOPPED_S = 0.2
SILENCE_S = 5.0  # longer than a guard tries, so no zero comes any more


class Driver:
    """A joystick that sends 20 commands a second, and knows what the gateway says."""

    def __init__(self, socket: ClientConnection) -> None:
        self._socket = socket
        self.is_pushed = False
        self.state: dict[str, object] = {}

    async def drive(self) -> None:
        with contextlib.suppress(OSError, EOFError):
            while True:
                twist = {"linear": {"x": 0.2}} if self.is_pushed else {}
                command = {"op": "publish", "topic": "/cmd_vel", "msg": twist}
                command["type"] = "geometry_msgs/Twist"
                await self._socket.send(json.dumps(command))
                await self._socket.send('{"op":"control"}')
                await asyncio.sleep(PERIOD_S)

    async def listen(self) -> None:
        async for text in self._socket:
            message = json.loads(text)
            if message["op"] == "control":
                self.state = message

    async def let_go_and_push(self) -> None:
        self.is_pushed = False
        await asyncio.sleep(LET_GO_S)
        self.is_pushed = True

    async def push_until(self, robot: Base, since_ns: int) -> None:
        """Push until the robot moves, with the stick let go of whenever that is refused."""
        async with asyncio.timeout(scene.START_S):
            while not robot.moved_after(since_ns):
                if not self.is_pushed or self.state.get("tripped"):
                    await self.let_go_and_push()
                for _ in range(100):
                    if robot.moved_after(since_ns):
                        return
                    await asyncio.sleep(0.001)


@contextlib.asynccontextmanager
async def driving(url: str) -> AsyncIterator[Driver]:
    async with connect(url, proxy=None, compression=None) as socket:
        driver = Driver(socket)
        tasks = [asyncio.create_task(each()) for each in (driver.drive, driver.listen)]
        try:
            yield driver
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)


@contextlib.asynccontextmanager
async def busy() -> AsyncIterator[None]:
    async with contextlib.AsyncExitStack() as loops:
        for _ in range(BUSY):
            await loops.enter_async_context(scene.process("tests.e2e.faults.busy_loop"))
        yield


@pytest.mark.brief
@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGKILL], ids=["clean", "crashed"])
@pytest.mark.parametrize("others", OTHERS)
async def test_a_robot_that_starts_again_stands_until_the_stick_is_let_go_and_is_stopped_for(
    measured, how: signal.Signals, others: int
):
    event = f"{'killed' if how is signal.SIGKILL else 'restarted'}, {others} others listen"
    async with contextlib.AsyncExitStack() as world:
        await world.enter_async_context(busy())
        for _ in range(others):
            await world.enter_async_context(scene.base())
        for number in range(TRIALS):
            kill_s = LATEST_KILL_S * number / max(1, TRIALS - 1)
            await trial(measured, event, how, kill_s)


async def trial(measured, event: str, how: signal.Signals, kill_s: float) -> None:
    async with scene.gateway() as gateway, driving(gateway.url) as driver:
        async with scene.base() as robot:
            await driver.push_until(robot, 0)
            robot.end(how)
            await until(lambda: not robot.is_running)
        async with scene.base() as robot:  # with the stick still held
            await until(lambda: bool(driver.state.get("tripped") or robot.moved_after(0)))
            assert robot.moved_after(0) == []
            await driver.push_until(robot, 0)
            await asyncio.sleep(kill_s)
            guard = guard_of(gateway)
            at_ns = time.monotonic_ns()
            gateway.process.kill()
            with contextlib.suppress(TimeoutError):
                await until(lambda: robot.zero_after(at_ns) is not None, within_s=SILENCE_S)
            zero_ns = robot.zero_after(at_ns)
            assert zero_ns is not None, f"{event}: no zero, killed {kill_s * 1000:.0f} ms later"
            took_s = (zero_ns - at_ns) / 1e9
            measured(f"gateway SIGKILL, robot {event}", took_s, allowed_s=STOPPED_S)
            await until(lambda: not is_running(guard))
            assert robot.moved_after(zero_ns) == []
