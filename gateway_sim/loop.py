# SPDX-License-Identifier: Apache-2.0
"""One thread for ROS callbacks and periodic tasks, from the process's start to its end."""

import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import FrameType
from typing import Final

import rclpy
from rclpy.context import Context
from rclpy.executors import Executor, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from gateway.ending_signals import ENDING
from gateway.sources.rclpy import fast_dds
from gateway.sources.rclpy.rclpy_private.handles import events_executor

PROFILE: Final = Path(__file__).with_name("fastdds_profile.xml")
_LONGEST_WAIT_NS: Final = 50_000_000  # the longest delay of a stop, which no person notices


@dataclass(slots=True)
class _Periodic:
    period_ns: int
    task: Callable[[], None]
    due_ns: int


class Loop:
    """Runs ROS callbacks as they come and tasks when they are due, all on the caller's thread."""

    def __init__(self, context: Context) -> None:
        self._executor = _executor(context)
        self._periodic: list[_Periodic] = []

    def add_node(self, node: Node) -> None:
        """Run the callbacks of *node* from now on."""
        self._executor.add_node(node)

    def every(self, period_ns: int, task: Callable[[], None]) -> None:
        """Call *task* now and at each full period after. Missed periods are skipped."""
        self._periodic.append(_Periodic(period_ns, task, time.monotonic_ns()))

    def run(self, stop: threading.Event) -> None:
        """Run until *stop* is set, and at most 50 ms and one task longer."""
        while not stop.is_set():
            now_ns = time.monotonic_ns()
            for periodic in self._periodic:
                if periodic.due_ns <= now_ns:
                    periodic.task()
                    missed = (time.monotonic_ns() - periodic.due_ns) // periodic.period_ns
                    periodic.due_ns += (missed + 1) * periodic.period_ns
            until_ns = min(
                (periodic.due_ns for periodic in self._periodic), default=now_ns + _LONGEST_WAIT_NS
            )
            wait_ns = min(until_ns - time.monotonic_ns(), _LONGEST_WAIT_NS)
            # Even with no time left to wait, run the callbacks that are ready.
            self.turn(max(0, wait_ns) / 1e9)

    def turn(self, timeout_s: float) -> None:
        """Wait at most *timeout_s* seconds for a callback, and run it."""
        self._executor.spin_once(timeout_sec=timeout_s)

    def close(self) -> None:
        """Release the nodes without destroying them."""
        for node in self._executor.get_nodes():
            self._executor.remove_node(node)
        self._executor.shutdown()


@contextmanager
def ros_context() -> Iterator[Context]:
    """Provide a separate ROS context that leaves signals alone and writes no log files.

    Images travel through shared memory, unless the environment names a profile itself.
    """
    arguments = ["--ros-args", "--disable-external-lib-logs"]
    context = Context()
    with fast_dds.profile(PROFILE, PROFILE):
        rclpy.init(args=arguments, context=context, signal_handler_options=SignalHandlerOptions.NO)
        try:
            yield context
        finally:
            context.try_shutdown()


@contextmanager
def stopped_by_signals(stop: threading.Event) -> Iterator[None]:
    """Let the `ENDING` signals set *stop*. Call it on the main thread."""

    def set_stop(_number: int, _frame: FrameType | None) -> None:
        stop.set()

    before = [signal.signal(number, set_stop) for number in ENDING]
    try:
        yield
    finally:
        for number, handler in zip(ENDING, before, strict=True):
            signal.signal(number, handler)


def _executor(context: Context) -> Executor:
    """Return the executor whose wait costs the same for 5 entities and for 500, if it exists."""
    return events_executor(context) or SingleThreadedExecutor(context=context)
