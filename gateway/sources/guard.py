# SPDX-License-Identifier: Apache-2.0
"""The interface to a source's guard, which stops the robot if this process cannot."""

from collections.abc import Callable, Collection
from types import TracebackType
from typing import Protocol

from typing_extensions import Self

from gateway.drive.effects import GuardState


class Guard(Protocol):
    """See `gateway.guard`. Nothing here blocks, and callbacks come on the event loop's thread."""

    @property
    def is_ready(self) -> bool:
        """True while it would stop a robot that moves."""

    @property
    def losses(self) -> int:
        """The number of times that it was lost."""

    def start(self) -> None:
        """Begin, once clients can connect. Commands to move wait until it is ready."""

    def open(
        self,
        topic: str,
        type_name: str,
        readers: Collection[str],
        on_state: Callable[[GuardState], None],
    ) -> None:
        """Prepare for a topic with the subscriptions of these ids, in place of those before.

        *on_state* is called with each new state but ``starting``.
        """

    def prove(self, topic: str, stamp_offset_ns: int, frame_id: str) -> None:
        """Prove that zeros reach the subscriptions: then the state becomes ``ready``.

        A request while the proof is under way changes nothing.
        """

    def close(self, topic: str) -> None:
        """Forget a topic that is at rest."""

    def moving(self, topic: str, stamp_offset_ns: int, frame_id: str) -> None:
        """Announce a command to move, before it goes out, and each zero until `rest`.

        *stamp_offset_ns* is ROS time less the monotonic clock, *frame_id* the command's.
        """

    def rest(self, topic: str) -> None:
        """Announce that the last zero of a stop has gone out."""


class GuardPublisher(Protocol):
    """A publisher of raw samples in the guard process."""

    @property
    def is_acknowledged(self) -> bool:
        """Return whether all matched reliable readers have what was published last.

        True if the middleware cannot tell.
        """

    def publish(self, cdr: bytes) -> None:
        """Publish one sample, encapsulation header included.

        Raises:
            RosError: it cannot be published now.
        """

    def close(self) -> None:
        """Destroy it."""


class GuardNode(Protocol):
    """A node of the guard process, which only publishes and has no event loop.

    Each source has a class of this kind. The gateway names it, and its arguments, as JSON.
    """

    def __enter__(self) -> Self:
        """Take part."""

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """End it."""

    def advertise(self, topic: str, type_name: str, lifespan_ns: int) -> GuardPublisher:
        """Create a publisher of the newest message on a fully resolved topic name.

        Raises:
            RosError: as for `gateway.sources.source.Publishing.advertise`.
        """

    def readers(self, topic: str) -> set[str]:
        """Return the ids of the subscriptions to a topic.

        See `gateway.sources.source.Publishing.readers`.
        """

    def moves(self, topic: str) -> None:
        """Note that the gateway is about to publish a command on a topic."""

    @property
    def is_cut_off(self) -> bool:
        """Return whether what the gateway publishes does not get through.

        Then the guard ends, and the gateway refuses commands until another one is ready.
        """

    def flush(self, timeout_s: float) -> None:
        """Wait until reliable readers have what was published, at most for a time."""
