# SPDX-License-Identifier: Apache-2.0
"""Notice that an entity of rcl has something to take, by a thread that waits for all of them.

It stands in for `gateway.sources.rclpy.ready_events.EventfdReadyEvents` where Python, the loop, rcl
or the middleware lacks what that needs: one more switch of threads for each batch, and no more
latency than that.
"""

import asyncio
import contextlib
import logging
import threading
from collections import deque
from collections.abc import Callable, Sequence
from typing import Any, Final

from rclpy.context import Context
from rclpy.node import Node

from gateway.faults import Fault
from gateway.sources.rclpy.errors import REFUSALS
from gateway.sources.rclpy.options import Taking
from gateway.sources.rclpy.rclpy_private import EntityWaitSet, Kind
from gateway.sources.rclpy.ready_events import EventfdReadyEvents, ReadyEvents, UnsupportedError

# After a failure that may come back at once, of waiting and of handling: neither may fill the log.
WAIT_PAUSE_S: Final = 1.0
HANDLING_PAUSE_S: Final = 0.1
# For the thread to end its wait, which takes microseconds. A machine may be busy.
RELEASE_S: Final = 1.0

_logger = logging.getLogger(__name__)


class WaitSetReadyEvents:
    """Reports arrivals from one thread, which sleeps until there is one.

    A ready source is left out of the next wait until the loop has taken it. Otherwise the wait
    would end at once.
    """

    def __init__(self, context: Context, loop: asyncio.AbstractEventLoop) -> None:
        self._context = context
        self._loop = loop
        self._wait_set = EntityWaitSet(context)
        self._awaited: dict[WaitSetSource, None] = {}
        self._removals: deque[threading.Event] = deque()  # each set by the end of a wait
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._run, name="ros_ready", daemon=True)
        self._thread.start()

    def open(
        self,
        kind: Kind,
        create: Callable[[], Any],
        destroy: Callable[[Any], object],
        on_ready: Callable[[], None],
        *,
        is_counted: bool = True,  # here nothing is
    ) -> "WaitSetSource":
        """Create an entity. See `gateway.sources.rclpy.ready_events.ReadyEvents`."""
        return WaitSetSource(self, self._loop, kind, create, destroy, on_ready)

    def add(self, source: "WaitSetSource") -> None:
        """Also wait for a source, until it is ready."""
        self._awaited[source] = None
        self._wait_set.wake()

    def remove(self, source: "WaitSetSource") -> None:
        """Wait for a source no more. Return once the wait that holds its entity has ended.

        A client that opens its topic again at once may want another type, which rmw refuses until
        then.
        """
        self._awaited.pop(source, None)
        has_let_go = threading.Event()
        self._removals.append(has_let_go)
        self._wait_set.wake()
        if self._thread.is_alive():
            has_let_go.wait(RELEASE_S)

    def faults(self) -> Sequence[Fault]:
        """Return whether the thread has ended."""
        if self._thread.is_alive():
            return ()
        return (Fault("dead", "the thread that waits for messages has ended"),)

    def close(self) -> None:
        """End the thread. No call comes after."""
        self._stopping.set()
        self._wait_set.wake()
        self._thread.join()
        self._wait_set.close()

    def _run(self) -> None:
        while not self._stopping.is_set():
            try:
                self._wait()
            except REFUSALS:
                if not self._context.ok():  # nothing comes any more. The port says so
                    return
                _logger.exception("waiting for messages failed")
                self._stopping.wait(WAIT_PAUSE_S)

    def _wait(self) -> None:
        sources = tuple(self._awaited)  # at once, as the loop's thread changes it
        try:
            ready = self._wait_set.wait([(source.kind, source.entity) for source in sources])
        finally:
            while self._removals:
                self._removals.popleft().set()
        for index in ready:
            self._awaited.pop(sources[index], None)
            self._loop.call_soon_threadsafe(sources[index].notify)


class WaitSetSource:
    """One entity, and whether the thread waits for it or the loop is to take from it."""

    def __init__(
        self,
        events: WaitSetReadyEvents,
        loop: asyncio.AbstractEventLoop,
        kind: Kind,
        create: Callable[[], Any],
        destroy: Callable[[Any], object],
        on_ready: Callable[[], None],
    ) -> None:
        self.kind: Final = kind
        self.entity = create()
        self._events = events
        self._loop = loop
        self._destroy = destroy
        self._on_ready = on_ready
        self._is_closed = False
        self._is_paused = False
        self._next: asyncio.Handle | None = None  # the call of `notify` that the loop has planned
        events.add(self)

    def notify(self) -> None:
        """Call *on_ready*, and wait for the entity again unless it asks for another call."""
        if self._is_closed:
            return
        self._cancel_next()
        try:
            self._on_ready()
        except BaseException:
            if self._next is None and not self._is_closed:
                self._next = self._loop.call_later(HANDLING_PAUSE_S, self.notify)
            raise
        if self._next is None and not self._is_closed and not self._is_paused:
            self._events.add(self)

    def notify_again(self) -> None:
        """Call *on_ready* once more, after other callbacks have had their turn."""
        self._is_paused = False
        self._cancel_next()
        self._next = self._loop.call_soon(self.notify)

    def pause(self) -> None:
        """Do not wait for it until `resume`: it is ready until others have taken from it."""
        self._is_paused = True

    def resume(self) -> None:
        """Wait for it again."""
        if self._is_paused and self._next is None and not self._is_closed:
            self._events.add(self)
        self._is_paused = False

    def clear(self) -> None:
        """Do nothing: what has arrived is not counted."""

    def count_take(self) -> bool:
        """Return false: what follows a message that cannot be read is ready, and reported again."""
        return False

    def close(self) -> None:
        """Stop waiting and destroy the entity, once the thread has let go of it."""
        if not self._is_closed:
            self._is_closed = True
            self._cancel_next()
            self._events.remove(self)
            self._destroy(self.entity)

    def _cancel_next(self) -> None:
        if self._next is not None:
            self._next.cancel()
            self._next = None


def open_ready_events(
    taking: Taking, node: Node, loop: asyncio.AbstractEventLoop, undo: contextlib.ExitStack
) -> ReadyEvents:
    """Return events by an eventfd, or by a thread where that is asked for or nothing else works."""
    if taking != "wait_set":
        try:
            events = EventfdReadyEvents(loop)
            events.check(node)
        except UnsupportedError:
            if taking == "eventfd":
                raise
        else:
            return events
    waiting = WaitSetReadyEvents(node.context, loop)
    undo.callback(waiting.close)
    return waiting
