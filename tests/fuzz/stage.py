# SPDX-License-Identifier: Apache-2.0
"""A gateway in a process, the rest of the robot by plain rclpy, and a loop for the clients."""

import asyncio
import contextlib
import json
import re
import signal
import threading
from collections.abc import Callable, Coroutine, Iterator
from concurrent.futures import Future
from typing import Any, TypeVar

from gateway.sources.actions import SUCCEEDED, GoalRequest
from gateway.sources.services import ServiceRequest
from tests.client import TIMEOUT_S
from tests.e2e.test_rough_disconnects import at_rest, health, left_behind
from tests.fuzz import types
from tests.fuzz.speaker import Speaker
from tests.fuzz.target import FaultError, check
from tests.gateway_process import GatewayProcess, gateway_process
from tests.sources.outside import Outside

T = TypeVar("T")

IMAGE = "sensor_msgs/msg/Image"
STRING = "std_msgs/msg/String"
SCAN = "sensor_msgs/msg/LaserScan"
ODOMETRY = "nav_msgs/msg/Odometry"
TOPICS = {"/camera": IMAGE, "/words": STRING, "/scan": SCAN, "/odom": ODOMETRY}
PICTURES = (
    {"width": 4, "height": 2, "step": 12, "encoding": "rgb8", "data": b"0123" * 6},
    {"width": 4, "height": 2, "step": 12, "encoding": "rgb8", "data": b"0123"},
    {"width": 2**31, "height": 1, "step": 1, "encoding": "32FC1", "data": b""},
    {"encoding": "none"},
)
SETBOOL, FIBONACCI = "std_srvs/srv/SetBool", "test_msgs/action/Fibonacci"
# closed as soon as the client has left
CLOSED_AT_ONCE = ("clients", "subscriptions", "services", "action_servers", "calls", "goals")
_FAULT = re.compile(r"Traceback|\bERROR\b|internal error|never retrieved")
_HOLD = "held the loop for"
# nothing here is about the budgets. The others are small enough to be met
SETTINGS = {
    "limits.client_time_share": 1,
    "limits.address_time_share": 1,
    "limits.max_subscriptions": 4,
    "limits.max_advertisements": 3,
    "limits.max_goals": 2,
    "limits.max_pending_calls": 4,
    "limits.max_message_bytes": 2**20,
    "images.workers": 1,  # each starts a thread when it is first needed
}


class HoldError(FaultError):
    """Something has held the event loop for too long, and nothing else is wrong."""


class Loop:
    """An event loop in a thread: clients answer pings while the next step is being made up."""

    def __init__(self) -> None:
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True)
        self._thread.start()

    def run(self, work: Coroutine[Any, Any, T]) -> T:
        return self.start(work).result(3 * TIMEOUT_S)

    def start(self, work: Coroutine[Any, Any, T]) -> Future[T]:
        return asyncio.run_coroutine_threadsafe(work, self._loop)

    def call(self, work: Callable[[], object]) -> None:
        self._loop.call_soon_threadsafe(work)

    def close(self) -> None:
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()


class Stage:
    """A gateway and a robot for the conversations."""

    def __init__(self, loop: Loop, gateway: GatewayProcess, outside: Outside) -> None:
        self.run = loop.run
        self.gateway = gateway
        self._publishers = {
            topic: outside.add_publisher(topic, name) for topic, name in TOPICS.items()
        }
        outside.add_service("/arm", SETBOOL, self._answer)
        outside.add_service("/silent", SETBOOL, lambda request: None)
        outside.add_action_server("/fib", FIBONACCI, self._finish, lambda goal: None)
        self._rest: dict[str, int] | None = None
        self._checked = 0  # lines of the log

    def open(self) -> Speaker:
        return self.run(Speaker.open(self.gateway.url))

    def publish(self, topic: str, number: int) -> None:
        """Let the robot publish a sample. Those of the camera may contradict themselves."""
        values: dict[str, Any] = {}
        if topic == "/camera":
            values = PICTURES[number % len(PICTURES)]
        elif topic == "/words":
            values = {"data": "grüße 🤖" * (number % 30)}
        self._publishers[topic].publish(types.types().get(TOPICS[topic]).encode(values, 0))

    def start_threads(self) -> None:
        """Have the gateway start those that take, make pictures, read, and write, which stay."""

        async def look() -> None:
            speaker = await Speaker.open(self.gateway.url)
            await speaker.say('{"op":"subscribe","topic":"/camera","type":"sensor_msgs/Image"}')
            async with asyncio.timeout(TIMEOUT_S):
                while not speaker.frames:
                    self.publish("/camera", 0)
                    await asyncio.sleep(0.05)
            latched = {"topic": "/latched", "type": STRING, "latch": True}
            for operation in (
                {"op": "advertise", **latched},
                {"op": "publish", "topic": "/latched", "msg": {"data": "kept"}},
                {"op": "subscribe", "topic": "/latched"},
            ):
                await speaker.say(json.dumps(operation))
            await speaker.until(
                lambda: any(each.get("topic") == "/latched" for each in speaker.frames)
            )
            await speaker.say('{"op":"fetch_asset","uri":"package://none/a.stl","id":"asset"}')
            await speaker.say('{"op":"generate","language":"python","types":["a/b"],"id":"code"}')
            for wanted in ("asset", "code"):
                await speaker.until(
                    lambda wanted=wanted: any(each.get("id") == wanted for each in speaker.frames)
                )
            await speaker.leave()

        self.run(look())

    def check_log(self) -> None:
        """See that the gateway lives, and has logged no fault."""
        check(self.gateway.process.returncode is None, "the gateway has ended", self.gateway.log)
        news = self.gateway.log[self._checked :]
        self._checked += len(news)  # later lines belong to another example
        faults = [line for line in news if _FAULT.search(line)]
        if faults and all(_HOLD in line for line in faults):
            raise HoldError("".join(faults))
        check(not faults, "".join(news[-200:]))

    def until_nobody_is_left(self) -> None:
        """Wait until all that clients had open is closed, except for what is kept for a while.

        A recording that a client has begun goes on without it, so end that first.
        """

        found: dict[str, Any] = {}

        async def left() -> None:
            speaker = await Speaker.open(self.gateway.url)
            await speaker.say('{"op":"record","action":"stop","id":"end"}')
            await speaker.until(lambda: speaker.frames)
            await speaker.leave()
            loop = asyncio.get_running_loop()
            async with asyncio.timeout(TIMEOUT_S):
                while True:
                    found.update(await loop.run_in_executor(None, health, self.gateway.url))
                    if not any(found[name] for name in CLOSED_AT_ONCE):
                        return
                    await asyncio.sleep(0.05)

        try:
            self.run(left())
        except TimeoutError:
            check(False, "left open", {name: found.get(name) for name in CLOSED_AT_ONCE})

    def until_at_rest(self) -> None:
        """Wait until nothing is open. From the second time on, until no more is there than then."""
        try:
            self._rest = self.run(at_rest(self.gateway, self._rest))
        except TimeoutError:
            check(False, "left", left_behind(self.gateway), "before", self._rest)

    def begin_to_measure(self) -> None:
        """Have a measured gateway report what holds its loop from now on."""
        self.gateway.process.send_signal(signal.SIGRTMIN)

    def _answer(self, request: ServiceRequest) -> None:
        request.answer(types.types().get(f"{SETBOOL}_Response").encode({"success": True}, 0))

    def _finish(self, goal: GoalRequest) -> None:
        goal.feedback(types.types().get(f"{FIBONACCI}_Feedback").encode({"sequence": [1]}, 0))
        goal.finish(SUCCEEDED, types.types().get(f"{FIBONACCI}_Result").encode({}, 0))


@contextlib.contextmanager
def open_stage(*arguments: str, module: str = "gateway") -> Iterator[Stage]:
    """Run a gateway and the rest of the robot until the context ends."""
    settings = [each for name, value in SETTINGS.items() for each in ("--set", f"{name}={value}")]
    ready: Future[tuple[Stage, asyncio.Event]] = Future()

    async def live(loop: Loop) -> None:
        """Be one task from the beginning to the end, as the process' readers need."""
        try:
            with contextlib.closing(Outside()) as outside:
                async with gateway_process(
                    "serve", *settings, *arguments, module=module
                ) as gateway:
                    over = asyncio.Event()
                    ready.set_result((Stage(loop, gateway, outside), over))
                    await over.wait()
        except BaseException as error:
            if not ready.done():
                ready.set_exception(error)
            raise

    with contextlib.closing(Loop()) as loop:
        living = loop.start(live(loop))
        stage, over = ready.result()
        try:
            yield stage
        finally:
            loop.call(over.set)
            living.result(2 * TIMEOUT_S)
