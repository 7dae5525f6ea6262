# SPDX-License-Identifier: Apache-2.0
"""A gateway that is killed and started again under load. Its clients come back by themselves."""

import asyncio
import contextlib
import itertools
import os
import signal
import socket
import time
from collections.abc import AsyncIterator, Iterator
from pathlib import Path

import pytest
import pytest_asyncio
from std_msgs.msg import String
from websockets.exceptions import WebSocketException

from gateway.codec.types import Types
from schemas.installed import InstalledDefinitions
from tests.client import Client, client, eventually
from tests.clients.driver import INSTALLED, ROSLIB_2, ROSLIBPY_2, Driver, driver
from tests.clients.robot import until
from tests.e2e.faults import scene
from tests.e2e.faults.conftest import REPEAT
from tests.e2e.faults.processes import SHARED_MEMORY, guard_of, is_old, is_running, segments_of
from tests.e2e.faults.scene import Base, Gateway, until_it_moves
from tests.sources.outside import Outside
from tests.unity import mono, package

pytestmark = [pytest.mark.asyncio(loop_scope="module"), pytest.mark.timeout(3600)]

STRING, IMAGE = "std_msgs/msg/String", "sensor_msgs/msg/Image"
WIDTH, HEIGHT = 640, 480
SETTLED = 40  # commands: two seconds
ECHO = Path(__file__).with_name("Echo.cs")

_numbers = itertools.count(1)


@pytest.fixture(scope="module")
def outside() -> Iterator[Outside]:
    outside = Outside("robot")
    yield outside
    outside.close()


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def robot() -> AsyncIterator[Base]:
    async with scene.base() as robot:
        yield robot


@pytest_asyncio.fixture(
    scope="module", loop_scope="module", params=(ROSLIBPY_2, ROSLIB_2, None), ids=str
)
async def comes_back(
    request: pytest.FixtureRequest, outside: Outside
) -> AsyncIterator["LibraryClient | UnityClient"]:
    """A client of each kind that is installed."""
    if request.param is None:
        if reason := mono.missing():
            pytest.skip(reason)
        unity = UnityClient(outside)
        yield unity
        await unity.close()
        return
    if not (INSTALLED / ".ready").exists():
        pytest.skip(f"no clients in {INSTALLED}: `sh tools/make-clients.sh VENV` installs them")
    async with driver(request.param) as running:
        yield LibraryClient(running, outside)


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as server:
        return int(server.getsockname()[1])


@contextlib.asynccontextmanager
async def load(port: int) -> AsyncIterator[None]:
    """Have a camera publish, and a client watch it whenever there is a gateway."""

    async def watch() -> None:
        while True:
            with contextlib.suppress(OSError, WebSocketException):
                async with client(f"ws://127.0.0.1:{port}/") as watcher:
                    await watcher.send(op="subscribe", topic="/camera", type=IMAGE)
                    await follow(watcher)
            await asyncio.sleep(0.1)

    async def follow(watcher: Client) -> None:
        async for _ in watcher.socket:
            pass

    values = {"width": WIDTH, "height": HEIGHT, "encoding": "mono8", "step": WIDTH}
    message = {**values, "data": [7] * (WIDTH * HEIGHT)}
    picture = Types(InstalledDefinitions()).get(IMAGE).encode(message, now_ns=0)
    async with scene.publisher("/camera", IMAGE) as camera:
        await camera.repeat(picture)
        watching = asyncio.create_task(watch())
        try:
            yield
        finally:
            watching.cancel()


class Traffic:
    """Two topics of a client, seen from the robot's side."""

    def __init__(self, outside: Outside, name: str) -> None:
        self.out, self.into = f"/{name}/out", f"/{name}/in"
        self.heard: list[str] = []
        self._publisher = outside.node.create_publisher(String, self.out, 10)
        outside.node.create_subscription(
            String, self.into, lambda message: self.heard.append(message.data), 10
        )

    def publish(self, text: str) -> None:
        self._publisher.publish(String(data=text))


class LibraryClient:
    """roslib or roslibpy, which connects again and restores what was open."""

    def __init__(self, library: Driver, outside: Outside) -> None:
        self.name = str(library.library)
        self._events = library.events
        self._connection = library.connection()
        self._traffic = Traffic(outside, self._connection.name)

    async def start(self, gateway: Gateway) -> None:
        await self._connection.connect(gateway, again=True)  # type: ignore[arg-type]  # its url
        await self._connection.subscribe(self._traffic.out, "std_msgs/String")

    async def is_back(self) -> None:
        """Wait until what is published on either side has come to the other."""
        await self._connection.next("connected")
        text = f"text {next(_numbers)}"

        async def has_come() -> bool:
            self._traffic.publish(text)
            await self._connection.publish(self._traffic.into, "std_msgs/String", {"data": text})
            return text in self._traffic.heard and any(
                event.kind == "message" and event.value == {"data": text} for event in self._events
            )

        await until(has_come)

    async def is_lost(self) -> None:
        await self._connection.next("closed")
        self._events.clear()


class UnityClient:
    """The client for Unity under Mono, which publishes what it hears."""

    name = "Unity client"

    def __init__(self, outside: Outside) -> None:
        self._process: asyncio.subprocess.Process | None = None
        self._traffic = Traffic(outside, f"unity_{os.getpid()}")
        core = package.compiled("Ros2Gateway.Core", package.EDITOR)
        self._program = mono.compile_assembly("echo.exe", [ECHO], references=[*core.closure()])

    async def start(self, gateway: Gateway) -> None:
        command = mono.command(self._program, gateway.url, self._traffic.out, self._traffic.into)
        environment = mono.environment(self._program)
        self._process = await asyncio.create_subprocess_exec(*command, env=environment)

    async def is_back(self) -> None:
        """Wait until what is published on one side has come back from the other."""
        text = f"text {next(_numbers)}"

        async def has_come() -> bool:
            self._traffic.publish(text)
            return text in self._traffic.heard

        await until(has_come)

    async def is_lost(self) -> None:
        """It is not asked: it is enough that its text comes back."""

    async def close(self) -> None:
        if self._process is not None:
            self._process.kill()
            await self._process.wait()


def gateways(outside: Outside) -> int:
    """Count the gateways in the ROS graph. A killed one stays there for about 20 s."""
    return outside.node.get_node_names().count("ros2_gateway_debug")


async def test_a_gateway_that_is_killed_and_started_again_leaves_nothing_and_loses_no_client(
    comes_back, robot: Base, outside: Outside, measured
):
    port = free_port()
    remains: set[str] = set()
    async with contextlib.AsyncExitStack() as stack:
        await stack.enter_async_context(load(port))
        driver_ = await stack.enter_async_context(scene.operator(f"ws://127.0.0.1:{port}/"))
        for repetition in range(REPEAT + 1):
            began_ns = time.monotonic_ns()
            async with scene.gateway("--port", str(port)) as gateway:
                if repetition == 0:
                    await comes_back.start(gateway)
                await comes_back.is_back()
                # a guard that has just begun may discover the robot later than the gateway does
                await until_it_moves(robot, driver_, since_ns=began_ns, commands=SETTLED)
                guard = guard_of(gateway)
                assert not [name for name in remains if (SHARED_MEMORY / name).exists()]
                if repetition == REPEAT:
                    break
                pids = (gateway.process.pid, guard)
                remains = {name for pid in pids for name in segments_of(pid)}
                assert remains
                await scene.until(lambda names=remains: all(map(is_old, names)))
                at_ns = time.monotonic_ns()
                os.kill(gateway.process.pid, signal.SIGKILL)
                await scene.until(lambda since=at_ns: robot.zero_after(since) is not None)
                zero_ns = robot.zero_after(at_ns)
                assert zero_ns is not None
                measured(
                    f"gateway SIGKILL under load, {comes_back.name}",
                    (zero_ns - at_ns) / 1e9,
                    allowed_s=0.2,
                )
                await scene.until(lambda pid=guard: not is_running(pid))
                assert robot.moved_after(zero_ns) == []
            await comes_back.is_lost()
        await eventually(lambda: gateways(outside) == 1)
