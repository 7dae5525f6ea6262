# SPDX-License-Identifier: Apache-2.0
"""A router over a ROS in memory, which other nodes also use. Nothing in it waits for a clock."""

import asyncio
import contextlib
import logging
from collections.abc import Awaitable, Callable, Iterator
from concurrent.futures import Executor, Future
from typing import Any

from gateway.config.control import ControlConfig
from gateway.config.limits import Limits
from gateway.core.router import Router
from gateway.fronts.rosbridge.front import RosbridgeFront
from gateway.sources.actions import SUCCEEDED, GoalRequest
from gateway.sources.services import ServiceRequest
from schemas.table import Table
from tests.fuzz import types
from tests.fuzz.target import check
from tests.sources.fake import FakeRos

LIMITS = Limits(
    max_subscriptions=4, max_advertisements=3, max_message_bytes=1 << 16, max_pending_calls=3
)
TABLE = Table.load()
IMAGE = "sensor_msgs/msg/Image"
PICTURE = {"width": 4, "height": 2, "step": 12, "encoding": "rgb8", "data": b"0123" * 6}
TURNS = 20  # of the event loop, in which all happens that does not wait for time


class Inline(Executor):
    """Does everything at once, in the same order each time."""

    def submit(self, work: Callable[..., Any], /, *args: Any, **more: Any) -> Future[Any]:
        future: Future[Any] = Future()
        try:
            future.set_result(work(*args, **more))
        except Exception as error:
            future.set_exception(error)
        return future


class Log(logging.Handler):
    """Keeps what must never be logged: tracebacks and faults of the gateway."""

    def __init__(self) -> None:
        super().__init__(logging.ERROR)
        self.faults: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        self.faults.append(self.format(record))


class World:
    """The gateway and the other nodes."""

    def __init__(self) -> None:
        self.ros = FakeRos()
        self.router = Router(
            self.ros, types.types(), TABLE, limits=LIMITS, workers=Inline(), version="fuzz"
        )
        self.front = RosbridgeFront(self.router)
        self._camera = self.ros.add_publisher("/camera", IMAGE)
        self._odometry = self.ros.add_publisher("/odom", "nav_msgs/msg/Odometry")
        self.ros.add_service("/motor_power", "std_srvs/srv/SetBool", self._answer)
        self.ros.add_service("/silent", "std_srvs/srv/Trigger", lambda request: None)
        self.ros.add_action_server(
            "/fib", "test_msgs/action/Fibonacci", self._finish, lambda goal: None
        )

    def publish(self) -> None:
        """Publish a sample on each topic, the second with a count beyond its end."""
        self._camera.publish(types.types().get(IMAGE).encode(PICTURE, 0))
        self._odometry.publish(self.ros.empty("nav_msgs/msg/Odometry"))
        self._odometry.publish(b"\0\1\0\0" + b"\xff" * 40)

    def _answer(self, request: ServiceRequest) -> None:
        request.answer(self.ros.empty("std_srvs/srv/SetBool_Response"))

    def _finish(self, goal: GoalRequest) -> None:
        goal.feedback(self.ros.empty("test_msgs/action/Fibonacci_Feedback"))
        goal.finish(SUCCEEDED, self.ros.empty("test_msgs/action/Fibonacci_Result"))


async def turns() -> None:
    for _ in range(TURNS):
        await asyncio.sleep(0)


def run_in_a_loop(work: Callable[[World], Awaitable[None]]) -> None:
    """Do *work*, and see that it leaves no task, no entity and no line in the log."""
    with asyncio.Runner() as runner, watched_log() as log:
        runner.run(_run(work, log))
    check(not log.faults, *log.faults)


async def _run(work: Callable[[World], Awaitable[None]], log: Log) -> None:
    loop = asyncio.get_running_loop()
    loop.set_exception_handler(lambda _, context: log.faults.append(repr(context)))
    world = World()
    await work(world)
    await turns()
    counts = world.router.counts()
    left = {name: count for name, count in counts.items() if count and name not in KEPT}
    check(counts["publishers"] <= len(ControlConfig().topics), "publishers left", counts)
    check(not left, "left behind", left)
    world.router.close()
    await turns()
    check(world.ros.entity_count() == 0, "entities left", world.ros.entity_count())
    others = asyncio.all_tasks() - {asyncio.current_task()}
    check(not others, "tasks left", others)


# The gateway keeps these open for a while after their last use. The publishers are those that
# stop a robot, with five commands within 250 ms.
KEPT = frozenset({"ros_entities", "service_clients", "action_clients", "publishers"})


@contextlib.contextmanager
def watched_log() -> Iterator[Log]:
    log = Log()
    product = logging.getLogger("gateway")
    asyncio_log = logging.getLogger("asyncio")
    for logger in (product, asyncio_log):
        logger.addHandler(log)
    was, product.propagate = product.propagate, False
    try:
        yield log
    finally:
        product.propagate = was
        for logger in (product, asyncio_log):
            logger.removeHandler(log)
