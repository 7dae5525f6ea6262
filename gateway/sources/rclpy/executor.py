# SPDX-License-Identifier: Apache-2.0
"""The threads that spin what needs an executor: parameters, simulated time, type descriptions."""

import logging
import threading
import time
from collections.abc import Sequence
from typing import Any, Final

from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.task import Future

from gateway.faults import Fault
from gateway.sources.rclpy.rclpy_private.handles import SPIN_S, events_executor

# After a callback that raised: a fault that comes back at once must not fill the log.
_PAUSE_S: Final = 1.0
STUCK_S: Final = 5.0  # callbacks take milliseconds. A machine may be busy

_logger = logging.getLogger(__name__)


class ExecutorThread:
    """One executor in one thread, from construction until `close`. Its callbacks run there.

    With *standard* it is rclpy's standard executor, which looks at every entity at each turn.
    Otherwise the executor that wakes only for what is ready, if rclpy has it.
    """

    def __init__(self, context: Context, *, standard: bool = False) -> None:
        executor = None if standard else events_executor(context)
        self._executor = executor or SingleThreadedExecutor(context=context)
        self._context = context
        self._stop: Any = Future()
        self._stopping = threading.Event()
        self._asked_s: float | None = None  # since when it owes an answer
        self._thread = threading.Thread(target=self._spin, name="ros_executor", daemon=True)
        self._thread.start()

    def add_node(self, node: Node) -> None:
        """Spin a node from now on."""
        self._executor.add_node(node)

    def faults(self) -> Sequence[Fault]:
        """Return whether the thread has ended, or has not answered for `STUCK_S`.

        It is asked here, and its answer is seen by the next call.
        """
        if not self._thread.is_alive():
            return (Fault("dead", "the thread that spins ROS has ended"),)
        now_s = time.monotonic()
        asked_s = self._asked_s  # read once: the other thread sets it
        if asked_s is None:
            self._asked_s = now_s
            self._executor.create_task(self._answer)
        elif (hung_s := now_s - asked_s) > STUCK_S:
            return (Fault("not ready", f"callbacks of ROS have hung for {hung_s:.0f} s"),)
        return ()

    def close(self) -> None:
        """Stop spinning and wait for the callback that may be running."""
        self._stopping.set()
        self._stop.set_result(None)
        self._executor.wake()
        self._thread.join()
        self._executor.shutdown()

    def _answer(self) -> None:
        self._asked_s = None

    def _spin(self) -> None:
        while not self._stopping.is_set():
            try:
                self._executor.spin_until_future_complete(self._stop, SPIN_S)
            except Exception:  # raised by a callback. The thread must outlive it
                if not self._context.ok():  # and nothing spins any more
                    _logger.error("ROS was shut down by something else than the gateway")
                    return
                _logger.exception("callback of ROS failed")
                self._stopping.wait(_PAUSE_S)
