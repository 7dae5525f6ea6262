# SPDX-License-Identifier: Apache-2.0
"""Clients that others wrote, each in a separate process that takes commands.

The commands are the same for every library. `driver.mjs` and `roslibpy_driver.py` carry them out
by what the library offers to its users.
"""

import asyncio
import contextlib
import itertools
import json
import os
import sys
from asyncio.subprocess import PIPE, Process
from collections.abc import AsyncIterator, Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tests.client import TIMEOUT_S
from tests.gateway_process import GatewayProcess

INSTALLED = Path(sys.prefix) / "clients"  # by tools/make-clients.sh
MAX_LINE_BYTES = 1 << 26

_HERE = Path(__file__).parent


class RefusedError(Exception):
    """The library reports a failure. `reason` is the reason that its user gets."""

    def __init__(self, reason: Any) -> None:
        super().__init__(str(reason))
        self.reason = reason


@dataclass(frozen=True)
class Library:
    """One version of one client library."""

    name: str
    version: str
    transport: str = ""

    def __str__(self) -> str:
        return "-".join(filter(None, (self.name, self.version, self.transport)))

    @property
    def is_javascript(self) -> bool:
        return self.name == "roslib"

    @property
    def directory(self) -> Path:
        return INSTALLED / f"{self.name}-{self.version}"

    @property
    def command(self) -> tuple[str, ...]:
        if self.is_javascript:
            return str(INSTALLED / "bin/node"), str(_HERE / "driver.mjs"), str(self.directory)
        return sys.executable, str(_HERE / "roslibpy_driver.py")

    @property
    def environment(self) -> dict[str, str]:
        # The older roslibpy stands before the newer, whose directory has what both need.
        path = os.pathsep.join(map(str, (self.directory, INSTALLED / "roslibpy-2.1.0")))
        return {"PYTHONPATH": path, "ROSLIBPY_TRANSPORT": self.transport}


ROSLIBPY_1 = Library("roslibpy", "1.8.1")
ROSLIBPY_2 = Library("roslibpy", "2.1.0")
ROSLIBPY_2_ASYNCIO = Library("roslibpy", "2.1.0", "asyncio")
ROSLIB_1 = Library("roslib", "1.4.1")
ROSLIB_2 = Library("roslib", "2.1.0")
LIBRARIES = (ROSLIBPY_1, ROSLIBPY_2, ROSLIBPY_2_ASYNCIO, ROSLIB_1, ROSLIB_2)


@dataclass(frozen=True)
class Event:
    """An unrequested report of a library: a message, a request, feedback, a warning ..."""

    kind: str
    connection: str
    name: str
    value: Any


@dataclass
class Driver:
    """A running library. Any number of connections may be made with it."""

    library: Library
    process: Process
    events: list[Event] = field(default_factory=list)
    _changed: asyncio.Event = field(default_factory=asyncio.Event)
    _answers: dict[int, asyncio.Future[Any]] = field(default_factory=dict)
    _numbers: Any = field(default_factory=lambda: itertools.count(1))

    def connection(self) -> "Connection":
        """Name a connection, which `connect` makes."""
        name = f"{self.library.name}_{self.process.pid}_{next(self._numbers)}"
        return Connection(self, name)

    async def do(self, connection: str, command: str, **arguments: Any) -> Any:
        """Carry out a command.

        Raises:
            RefusedError: The library reports a failure.
        """
        number = next(self._numbers)
        answer = self._answers[number] = asyncio.get_running_loop().create_future()
        line = {"n": number, "do": command, "connection": connection, **arguments}
        assert self.process.stdin is not None
        self.process.stdin.write(json.dumps(line).encode() + b"\n")
        async with asyncio.timeout(TIMEOUT_S):
            return await answer

    async def event(self, wanted: Callable[[Event], bool]) -> Event:
        """Wait for the first event that is wanted, and take it."""
        try:
            async with asyncio.timeout(TIMEOUT_S):
                while True:
                    for event in self.events:
                        if wanted(event):
                            self.events.remove(event)
                            return event
                    self._changed.clear()
                    await self._changed.wait()
        except TimeoutError:
            raise AssertionError(f"{self.library} only told {self.events[-10:]}") from None

    def take(self, kind: str) -> list[Any]:
        """Return the values of the events of a kind so far, and forget them."""
        taken = [event for event in self.events if event.kind == kind]
        self.events = [event for event in self.events if event.kind != kind]
        return [event.value for event in taken]

    async def follow(self) -> None:
        """Take in what the process writes, until it ends."""
        assert self.process.stdout is not None
        async for line in self.process.stdout:
            told = json.loads(line)
            if "event" in told:
                told["kind"] = told.pop("event")
                self.events.append(Event(**told))
                self._changed.set()
                continue
            answer = self._answers.pop(told["n"])
            if answer.done():
                continue
            if "failure" in told:
                answer.set_exception(RefusedError(told["failure"]))
            else:
                answer.set_result(told["result"])


@dataclass(frozen=True)
class Connection:
    """A connection of a library to a gateway."""

    driver: Driver
    name: str

    @property
    def library(self) -> Library:
        return self.driver.library

    def own(self, name: str) -> str:
        """Return a name of the ROS graph that no other test uses."""
        return f"/{self.name}/{name}"

    async def do(self, command: str, **arguments: Any) -> Any:
        """Carry out a command on this connection. See `Driver.do`."""
        return await self.driver.do(self.name, command, **arguments)

    async def connect(
        self, gateway: GatewayProcess, *, again: bool = False, token: str | None = None
    ) -> None:
        """Connect, and *again* by the library's own means whenever the connection is lost.

        roslibpy shows its *token* in a header, roslib in a first frame: a browser sets no headers.
        """
        await self.do("connect", url=gateway.url, again=again, token=token)

    async def close(self) -> None:
        """End the connection for good."""
        await self.do("close")

    async def subscribe(self, topic: str, type_name: str, **options: Any) -> None:
        """Subscribe. Messages are events."""
        await self.do("subscribe", topic=topic, type_name=type_name, options=options)

    async def publish(self, topic: str, type_name: str, message: Any, **options: Any) -> None:
        """Publish, advertising the topic first if it is not."""
        await self.do("publish", topic=topic, type_name=type_name, message=message, options=options)

    async def is_awaited(self, topic: str) -> None:
        """Wait until the gateway knows a subscriber: what is published before reaches nobody."""
        about = {"topic": topic}
        async with asyncio.timeout(TIMEOUT_S):
            while True:
                known = await self.call("/rosapi/subscribers", "rosapi/Subscribers", about)
                if known["subscribers"]:
                    return
                await asyncio.sleep(0.05)

    async def call(
        self, service: str, type_name: str, args: Any, *, timeout_s: float | None = None
    ) -> Any:
        """Call a service. Only roslib 2 sends the *timeout_s* to the gateway."""
        about = {"service": service, "type_name": type_name, "args": args}
        return await self.do("call_service", **about, timeout=timeout_s)

    async def provide(
        self, service: str, type_name: str, values: Any, *, succeeds: bool = True
    ) -> None:
        """Provide a service whose answer is always the same. Requests are events."""
        about = {"service": service, "type_name": type_name}
        await self.do("advertise_service", **about, values=values, result=succeeds)

    async def send_goal(self, action: str, type_name: str, goal: Any) -> str:
        """Send a goal and return its id. Feedback, result and failure are events."""
        return str(await self.do("send_goal", action=action, type_name=type_name, goal=goal))

    async def ask(self, question: str, *args: Any) -> Any:
        """Ask one of the questions of Ros, such as ``get_topics``."""
        return await self.do("ask", question=question, args=args)

    async def next(self, kind: str, name: str = "") -> Any:
        """Wait for an event on this connection, and return its value."""
        event = await self.driver.event(
            lambda event: (event.kind, event.connection, event.name) == (kind, self.name, name)
        )
        return event.value


@contextlib.asynccontextmanager
async def driver(library: Library) -> AsyncIterator[Driver]:
    """Run a library until the context ends."""
    process = await asyncio.create_subprocess_exec(
        *library.command,
        stdin=PIPE,
        stdout=PIPE,
        env={**os.environ, **library.environment},
        limit=MAX_LINE_BYTES,
    )
    running = Driver(library, process)
    async with asyncio.TaskGroup() as readers:
        readers.create_task(running.follow())
        try:
            yield running
        finally:
            assert process.stdin is not None
            process.stdin.close()
            try:
                async with asyncio.timeout(TIMEOUT_S):
                    await process.wait()
            except TimeoutError:
                process.kill()
                await process.wait()
