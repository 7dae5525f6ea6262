# SPDX-License-Identifier: Apache-2.0
"""Entries that wait to be sent, the owner of their queue, and the socket that they go to."""

import enum
from collections.abc import Callable
from typing import Final, Literal, Protocol, TypeAlias

from gateway.codec.chunks import Chunks


class NoFrame(enum.Enum):
    """Why an entry has no frame to send."""

    NOT_READY = "not ready"  # a worker encodes it: ask again when the session is woken
    NOTHING = "nothing"  # it cannot be encoded, and never will be


NOT_READY: Final[Literal[NoFrame.NOT_READY]] = NoFrame.NOT_READY
NOTHING: Final[Literal[NoFrame.NOTHING]] = NoFrame.NOTHING

Frame: TypeAlias = bytes | Chunks | Literal[NoFrame.NOT_READY, NoFrame.NOTHING]


class Entry(Protocol):
    """Something to be sent, encoded when its turn has come."""

    @property
    def size(self) -> int:
        """The bytes that this entry keeps alive while it waits."""

    @property
    def is_being_encoded(self) -> bool:
        """True while a worker encodes it: it must not be dropped any more."""

    @property
    def arrived_ns(self) -> int:
        """The time at which DDS had it, by the system clock. 0 if it did not just come from DDS."""

    def frame(self) -> Frame:
        """Return the bytes to send, WebSocket header included, or why it has no bytes."""


class PacedSocket(Protocol):
    """A client's socket, for frames that need not wait. See `gateway.transport.pacing`.

    The caller subtracts the bytes from the room after it writes: `write` may itself leave none.
    """

    room_bytes: int
    """The bytes that may be written now. None or fewer while the socket or the link is full."""

    write: Callable[[bytes], object]

    def look(self) -> None:
        """Ask the link how many bytes may be written now."""


WriteDirectly = Callable[[Entry], int]
"""Write an entry to the socket. Return its bytes, 0 if it is not ready or the socket is busy."""


class QueueOwner(Protocol):
    """Answers what a queue asks, and hears what becomes of the entries in it."""

    def is_latched(self) -> bool:
        """Return whether its topic says each thing once: then no entry stands for an older one."""

    def has_sent(self, size: int) -> None:
        """Take the bytes of a frame that has waited, and was just handed to the socket."""

    def has_timed(self, arrived_ns: int) -> None:
        """Take the arrival of an entry that was just handed to the socket, one in `TIMED_EVERY`."""
