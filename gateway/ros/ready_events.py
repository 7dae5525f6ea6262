# SPDX-License-Identifier: Apache-2.0
"""Notice to the event loop that an entity of rcl has something to take.

`EventfdReadyEvents` is the fast way. The listener thread of DDS writes an eventfd, in C and without
the GIL, and the loop takes what has arrived itself. It needs
`gateway.ros.rclpy_private.ReadyCallbacks`; `PolledReadyEvents` needs only the loop's clock.
"""

import asyncio
import contextlib
import os
from collections.abc import Callable
from functools import partial
from typing import Any, Final, Protocol

from gateway.config.limits import MAX_QUEUE_DEPTH
from gateway.ros.rclpy_private import Kind, MissingFunctionError, ReadyCallbacks

# adds 10 ms at most to a call; an idle entity costs 0.1 % of a core
POLL_S: Final = 0.01


class UnsupportedError(Exception):
    """Raised when this platform or this ROS lacks what `EventfdReadyEvents` needs."""


class EventSource(Protocol):
    """An entity of rcl that the event loop takes from."""

    @property
    def entity(self) -> Any:
        """The entity as rclpy created it."""

    def notify_again(self) -> None:
        """Call *on_ready* once more, after other callbacks have had their turn."""

    def count_take(self) -> bool:
        """Count one take of any outcome; return whether a message is known to have been there.

        rclpy returns the same for a message that it cannot read as for no message.
        """

    def close(self) -> None:
        """Stop calling *on_ready* and destroy the entity. Closing twice is harmless."""


class ReadyEvents(Protocol):
    """A way to report arrivals to the event loop; no executor may spin the entities' node."""

    def open(
        self,
        kind: Kind,
        create: Callable[[], Any],
        destroy: Callable[[Any], object],
        on_ready: Callable[[], None],
    ) -> EventSource:
        """Create an entity; *on_ready* is called on the loop's thread while it has something.

        One call may stand for many events, or for none. Raises what *create* raises.
        """


class EventfdReadyEvents:
    """Reports arrivals by an eventfd for each entity."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        """Find what this needs.

        Raises:
            UnsupportedError: rcl, libc, Python or the loop lacks it.
        """
        _require_readers(loop)
        self._loop = loop
        try:
            self._hooks = ReadyCallbacks()
        except MissingFunctionError as error:
            raise UnsupportedError(str(error)) from error

    def open(
        self,
        kind: Kind,
        create: Callable[[], Any],
        destroy: Callable[[Any], object],
        on_ready: Callable[[], None],
        *,
        is_counted: bool = True,
    ) -> "EventfdSource":
        """Create an entity; see `ReadyEvents`.

        If it is not counted, *on_ready* must call `EventfdSource.clear`, and nobody `count_take`.
        """
        return EventfdSource(
            self._loop, self._hooks, kind, create, destroy, on_ready, is_counted=is_counted
        )


class EventfdSource:
    """One entity and the eventfd that counts what arrives at it."""

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
        """Forget what has arrived so far; from *on_ready* of a source that is not counted."""

    def notify_again(self) -> None:
        """Call *on_ready* once more, after other callbacks have had their turn."""
        self._repeats += 1
        os.eventfd_write(self._fd, 1)

    def count_take(self) -> bool:
        """Count one take; see `EventSource`."""
        if not self._pending:
            self._count()
        is_pending = self._pending > 0
        self._pending -= is_pending
        return is_pending

    def close(self) -> None:
        """Stop counting, destroy the entity, close the eventfd: the steps of opening, backwards.

        In any other order the thread of DDS might write into a file that reuses the descriptor.
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


class PolledReadyEvents:
    """Reports nothing: the loop looks at each entity every `POLL_S`."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop

    def open(
        self,
        kind: Kind,  # all are looked at in the same way
        create: Callable[[], Any],
        destroy: Callable[[Any], object],
        on_ready: Callable[[], None],
    ) -> "PolledSource":
        """Create an entity; see `ReadyEvents`."""
        return PolledSource(self._loop, create, destroy, on_ready)


class PolledSource:
    """One entity and the timer for the next look at it."""

    def __init__(
        self,
        loop: asyncio.AbstractEventLoop,
        create: Callable[[], Any],
        destroy: Callable[[Any], object],
        on_ready: Callable[[], None],
    ) -> None:
        self._loop = loop
        self._on_ready = on_ready
        self._destroy = destroy
        self.entity = create()
        self._is_closed = False
        self._next: asyncio.Handle = loop.call_soon(self._look)

    def notify_again(self) -> None:
        """Call *on_ready* once more, after other callbacks have had their turn."""
        self._next.cancel()
        self._next = self._loop.call_soon(self._look)

    def count_take(self) -> bool:
        """Return false: what follows a message that cannot be read waits for the next look."""
        return False

    def close(self) -> None:
        """Stop looking and destroy the entity. Closing twice is harmless."""
        if not self._is_closed:
            self._is_closed = True
            self._next.cancel()
            self._destroy(self.entity)

    def _look(self) -> None:
        self._next = self._loop.call_later(POLL_S, self._look)
        self._on_ready()


def _require_readers(loop: asyncio.AbstractEventLoop) -> None:
    if not hasattr(os, "eventfd"):
        raise UnsupportedError("this Python has no eventfd")
    fd = os.eventfd(0, os.EFD_CLOEXEC)
    try:
        loop.add_reader(fd, _never_called)
        loop.remove_reader(fd)
    except NotImplementedError as error:
        raise UnsupportedError("this event loop watches no file descriptors") from error
    finally:
        os.close(fd)


def _never_called() -> None:
    """Serve as the callback that the loop requires."""
