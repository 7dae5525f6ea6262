# SPDX-License-Identifier: Apache-2.0
"""The interface to a source's guard, which stops the robot if this process cannot."""

from collections.abc import Callable, Collection
from typing import Protocol

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
