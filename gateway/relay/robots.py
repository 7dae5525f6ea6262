# SPDX-License-Identifier: Apache-2.0
"""The robots of a relay: each is served while it is there, and for a while after it has gone."""

import asyncio
import logging
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractAsyncContextManager, suppress
from typing import Any, Final

from gateway.backports import timeout
from gateway.config.model import TAKEN_PATHS
from gateway.errors import GatewayError
from gateway.faults import Fault
from gateway.serving import FindFaults, ServedRobot
from gateway.transport.robot_paths import RobotPaths

logger = logging.getLogger("gateway")

# Viewers of a robot that has lost its network keep their connections for so long.
KEPT_S: Final = 60.0
RETRY_S: Final = 2.0  # after a failed attempt to serve a robot
# names whose paths the relay answers itself
RESERVED: Final = frozenset(path.split("/")[1] for path in TAKEN_PATHS)

OpenRobot = Callable[[str, FindFaults], AbstractAsyncContextManager[ServedRobot]]


class _Robot:
    """A robot that is there, or was a short time ago."""

    def __init__(self) -> None:
        self.has_ended = asyncio.Event()
        self.served: ServedRobot | None = None
        self.failure: str | None = None  # why it is not served
        self.is_there = True
        self.timer: asyncio.TimerHandle | None = None  # until it has ended, while it is away
        self.task: asyncio.Task[None] | None = None

    def comes(self) -> None:
        self.is_there = True
        if self.timer is not None:
            self.timer.cancel()
            self.timer = None

    def goes(self) -> None:
        self.is_there = False
        if self.timer is None:
            self.timer = asyncio.get_running_loop().call_later(KEPT_S, self.has_ended.set)

    def faults(self) -> Sequence[Fault]:
        if not self.is_there:
            text = "the robot is not connected to the Zenoh router: check the robot's network"
            return (Fault("not ready", text),)
        return ()


class Robots:
    """Serves each robot that the router lists, up to *max_robots*, one independent of another."""

    def __init__(self, open_robot: OpenRobot, paths: RobotPaths, max_robots: int) -> None:
        self._open, self._paths, self._max = open_robot, paths, max_robots
        self._robots: dict[str, _Robot] = {}
        self._left_out: dict[str, None] = {}  # the first first
        self._is_closed = False

    def note(self, name: str, is_there: bool) -> None:  # as the watch reports it
        """Take note of a robot that comes or goes."""
        robot = self._robots.get(name)
        if not is_there:
            self._left_out.pop(name, None)
            if robot is not None:
                logger.warning("robot %s has lost the Zenoh router", name)
                robot.goes()
        elif robot is not None:
            robot.comes()
        elif name in RESERVED:
            logger.error("robot %s cannot be served, its path is the relay's: rename it", name)
        elif len(self._robots) >= self._max:
            self._leave_out(name)
        elif not self._is_closed:
            self._begin(name)

    def faults(self) -> Sequence[Fault]:
        """Return what is wrong with robots."""
        found = [
            Fault("degraded", f"robot {name}: {robot.failure}")
            for name, robot in self._robots.items()
            if robot.failure is not None
        ]
        if self._left_out:
            text = f"{self._max} robots are served, the maximum (relay.max_robots), and others not"
            found.append(Fault("degraded", text))
        return found

    def details(self) -> Mapping[str, Any]:
        """Return the state of each robot, by its name."""
        return {
            name: {"status": "not ready"}
            if robot.served is None
            else {
                "status": robot.served.server.judged().status,
                "clients": robot.served.router.counts()["clients"],
            }
            for name, robot in sorted(self._robots.items())
        }

    def served(self) -> Sequence[ServedRobot]:
        """Return what serves the robots."""
        return [each.served for each in self._robots.values() if each.served is not None]

    async def close(self) -> None:
        """End all."""
        self._is_closed = True
        tasks = []
        for robot in self._robots.values():
            robot.comes()
            robot.has_ended.set()
            if robot.task is not None:
                tasks.append(robot.task)
        await asyncio.gather(*tasks, return_exceptions=True)

    def _leave_out(self, name: str) -> None:
        if not self._left_out:
            text = "robot %s is left out: %d robots are served, the maximum (relay.max_robots)"
            logger.error(text, name, self._max)
        if len(self._left_out) < self._max:  # bounded as well
            self._left_out[name] = None

    def _begin(self, name: str) -> None:
        robot = self._robots[name] = _Robot()
        robot.task = asyncio.create_task(self._serve(name, robot), name=f"robot_{name}")

    async def _serve(self, name: str, robot: _Robot) -> None:
        while not robot.has_ended.is_set():
            try:
                await self._serve_once(name, robot)
            except asyncio.CancelledError:
                raise
            except GatewayError as error:
                logger.error("robot %s cannot be served: %s", name, error)
                robot.failure = str(error)
            except Exception:  # our fault must not end what serves the other robots
                logger.exception("robot %s cannot be served", name)
                robot.failure = "it cannot be served because of an internal error: see the log"
            with suppress(TimeoutError):
                async with timeout(RETRY_S):
                    await robot.has_ended.wait()
        del self._robots[name]
        if self._is_closed:
            return
        if robot.is_there:  # again, before it had ended
            self._begin(name)
        elif self._left_out:
            following = next(iter(self._left_out))
            del self._left_out[following]
            self._begin(following)

    async def _serve_once(self, name: str, robot: _Robot) -> None:
        async with self._open(name, robot.faults) as served:
            robot.served, robot.failure = served, None
            self._paths.servers[name] = served.server
            logger.info("robot %s is served at /%s/", name, name)
            try:
                await robot.has_ended.wait()
            finally:
                robot.served = None
                del self._paths.servers[name]
                served.router.stop_robots()
                await served.server.close_clients(f"robot {name} is no longer connected")
        logger.info("robot %s is no longer served", name)
