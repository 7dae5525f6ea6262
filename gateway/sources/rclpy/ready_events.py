# SPDX-License-Identifier: Apache-2.0
"""Notice to the event loop that an entity of rcl has something to take.

The listener thread of DDS writes an eventfd, in C and without the GIL, and the loop takes what has
arrived itself.
"""

import asyncio
import contextlib
import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, Final

from rcl_interfaces.msg import ParameterEvent
from rclpy.node import Node
from rclpy.qos import QoSProfile

from gateway.config.limits import MAX_QUEUE_DEPTH
from gateway.sources.rclpy.errors import creation
from gateway.sources.rclpy.no_callbacks import NO_SUBSCRIPTION_EVENTS
from gateway.sources.rclpy.rclpy_private.c_functions import MissingFunctionError
from gateway.sources.rclpy.rclpy_private.readiness import Kind, ReadyCallbacks
from gateway.sources.source import RosError

# The default of ROS is also reliable and volatile, but keeps 10: the rest of a burst is lost.
SERVICE_PROFILE: Final = QoSProfile(depth=MAX_QUEUE_DEPTH)


class ReadyEvents:
    """Reports arrivals by an eventfd for each entity. No executor may spin the entities' node."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        """Find what this needs.

        Raises:
            RosError: ``internal``: rcl lacks it.
        """
        self._loop = loop
        try:
            self._hooks = ReadyCallbacks()
        except MissingFunctionError as error:
            raise _unsupported(error) from error

    def check(self, node: Node) -> None:
        """Check that the middleware reports arrivals at all, with a subscription of a node.

        Raises:
            RosError: ``internal``: it does not.
        """
        with creation("starting ROS"):
            subscription = node.create_subscription(
                ParameterEvent, "~/_ready", _never_called, 1, event_callbacks=NO_SUBSCRIPTION_EVENTS
            )
        try:
            self._hooks.stop("subscription", subscription)
        except RuntimeError as error:
            raise _unsupported(error) from error
        finally:
            node.destroy_subscription(subscription)

    def open(
        self,
        kind: Kind,
        create: Callable[[], Any],
        destroy: Callable[[Any], object],
        on_ready: Callable[[], None],
        *,
        is_counted: bool = True,
    ) -> "EventSource":
        """Create an entity. *on_ready* is called on the loop's thread while it has something.

        One call may stand for many events, or for none. If it is not counted, *on_ready* must call
        `EventSource.clear`, and nobody `count_take`. Raises what *create* raises.
        """
        return EventSource(
            self._loop, self._hooks, kind, create, destroy, on_ready, is_counted=is_counted
        )


class EventSource:
    """One entity that the event loop takes from, and the eventfd that counts what arrives at it."""

    def __init__(
        self,
        loop: asyncio.AbstractEventLoop,
        hooks: ReadyCallbacks,
        kind: Kind,
        create: Callable[[], Any],
        destroy: Callable[[Any], object],
        on_ready: Callable[[], None],
        *,
        is_counted: bool,
    ) -> None:
        self._on_ready = on_ready
        self._pending = 0  # arrivals that were counted and not taken yet
        self._repeats = 0  # of what the eventfd counts, those by `notify_again`
        with contextlib.ExitStack() as undo:
            # non-blocking: the thread of DDS must not wait when the loop does not read
            self._fd = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)
            undo.callback(os.close, self._fd)
            self.entity = create()
            undo.callback(destroy, self.entity)
            loop.add_reader(self._fd, self._count_and_notify if is_counted else on_ready)
            undo.callback(loop.remove_reader, self._fd)
            hooks.count(kind, self.entity, self._fd)
            undo.callback(hooks.stop, kind, self.entity)
            self._undo = undo.pop_all()
        # Bound rather than wrapped: the data path calls it for every batch.
        self.clear: Callable[[], object] = partial(os.eventfd_read, self._fd)
        """Forget what has arrived so far. From *on_ready* of a source that is not counted."""

    def notify_again(self) -> None:
        """Call *on_ready* once more, after other callbacks have had their turn."""
        self._repeats += 1
        os.eventfd_write(self._fd, 1)

    def count_take(self) -> bool:
        """Count one take of any outcome. Return whether a message is known to have been there.

        rclpy returns the same for a message that it cannot read as for no message.
        """
        if not self._pending:
            self._count()
        is_pending = self._pending > 0
        self._pending -= is_pending
        return is_pending

    def close(self) -> None:
        """Stop calling *on_ready*, and destroy the entity. Closing twice is harmless.

        These are the steps of opening, backwards. In any other order the thread of DDS might write
        into a file that reuses the descriptor.
        """
        self._undo.close()

    def _count_and_notify(self) -> None:
        # Before *on_ready*: whatever that raises, the loop does not call it again for nothing new.
        self._count()
        self._on_ready()

    def _count(self) -> None:
        try:
            arrived = os.eventfd_read(self._fd) - self._repeats
        except BlockingIOError:  # nothing has arrived since, or a take has read it
            return
        self._repeats = 0
        self._pending = min(self._pending + arrived, MAX_QUEUE_DEPTH)  # DDS has dropped the rest


@dataclass(frozen=True, slots=True)
class Endpoints:
    """The loop of clients and servers, and the node to create them on, which nothing spins."""

    node: Node
    ready_events: ReadyEvents
    loop: asyncio.AbstractEventLoop


def _unsupported(error: Exception) -> RosError:
    text = f"this middleware does not report arrivals ({error}): use RMW_IMPLEMENTATION="
    return RosError("internal", f"{text}rmw_fastrtps_cpp")


def _never_called(*_: object) -> None:
    """Serve as the callback that rclpy requires."""
