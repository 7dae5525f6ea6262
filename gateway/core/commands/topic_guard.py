# SPDX-License-Identifier: Apache-2.0
"""The guard of one command topic: the subscriptions that it knows, and whether it watches."""

from collections.abc import Callable

from gateway.core.names import TopicName
from gateway.drive.effects import GuardState
from gateway.sources.guard import Guard
from gateway.sources.source import Ros


class TopicGuard:
    """Has the guard process prepare for the subscriptions, watch what moves, and rest.

    *on_state* hears of each state.
    """

    def __init__(
        self,
        topic: TopicName,
        guard: Guard,
        ros: Ros,
        on_state: Callable[[GuardState], None],
    ) -> None:
        self.type_name: str | None = None  # that it has prepared for
        self.readers: frozenset[str] = frozenset()  # the ids of subscriptions that ROS knows
        self._topic = topic
        self._guard = guard
        self._ros = ros
        self._on_state = on_state
        self._is_watching = False
        self._is_sent = True  # the last command

    def prepare(self, type_name: str) -> None:
        """Have it open its publisher of a type, unless it has."""
        if type_name == self.type_name:
            return
        if self.type_name is not None:
            self._guard.close(self._topic)
        self.type_name = type_name
        self._on_state("starting")
        self.readers = self._ros.publishing.readers(self._topic)
        self._guard.open(self._topic, type_name, self.readers, self._on_state)

    def look_for_readers(self) -> None:
        """Start again for a new subscription of another node, which may be a robot's.

        So a robot that joins does not move until the joystick is released.
        """
        known, self.readers = self.readers, self._ros.publishing.readers(self._topic)
        if self.type_name is not None and not self.readers <= known:
            self._on_state("starting")
            self._guard.open(self._topic, self.type_name, self.readers, self._on_state)

    def prove(self, stamp_offset_ns: int, frame_id: str) -> None:
        """Have it prove that its zeros arrive."""
        self._guard.prove(self._topic, stamp_offset_ns, frame_id)

    def announce(self, stamp_offset_ns: int, frame_id: str, *, is_zero: bool) -> None:
        """Have it watch from the first command to move, and until it rests."""
        if self._is_watching or not is_zero:
            self._is_watching = True
            self._guard.moving(self._topic, stamp_offset_ns, frame_id)

    def will_send(self) -> None:
        """Note that a command is on its way out: until `has_sent` it may have failed."""
        self._is_sent = False

    def has_sent(self) -> None:
        """Note that the command has gone out."""
        self._is_sent = True

    @property
    def is_watching(self) -> bool:
        """True from the first command to move until it may rest."""
        return self._is_watching

    def rest(self) -> None:
        """Let it rest, unless the last zero has not gone out: then it stops the robot."""
        if self._is_watching and self._is_sent:
            self._is_watching = False
            self._guard.rest(self._topic)

    def close(self) -> None:
        """Have it forget the topic, unless it still has to stop the robot."""
        if self.type_name is not None and not self._is_watching:
            self._guard.close(self._topic)
            self.type_name = None
