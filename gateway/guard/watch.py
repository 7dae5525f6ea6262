# SPDX-License-Identifier: Apache-2.0
"""The guard's decisions: messages and times in, topics to stop out."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from gateway.drive.stop import ZERO_PERIOD_NS, ZEROS

# Until a robot has discovered the guard's publisher, zeros do not count. This is longer than
# discovery takes on a busy machine. If it is over, there is no robot.
UNHEARD_NS: Final = 4_000_000_000


@dataclass(slots=True)
class _Watched:
    is_moving: bool = False
    heard_ns: int = 0
    zeros_left: int = 0
    next_zero_ns: int = 0
    began_ns: int = 0


class CommandWatch:
    """The topics that are open, and which of them move a robot."""

    def __init__(self, silence_ns: int) -> None:
        self._silence_ns = silence_ns
        self._topics: dict[str, _Watched] = {}

    @property
    def due_ns(self) -> int | None:
        """The time at which `stops` has something to do, if nothing is heard before."""
        times = [each.next_zero_ns for each in self._topics.values() if each.zeros_left]
        moving = [each for each in self._topics.values() if each.is_moving]
        times += [each.heard_ns + self._silence_ns for each in moving]
        return min(times, default=None)

    @property
    def is_stopping(self) -> bool:
        """Return whether a stop is under way."""
        return any(each.zeros_left for each in self._topics.values())

    def open(self, topic: str) -> None:
        """Watch a topic. Nothing moves yet."""
        self._topics.setdefault(topic, _Watched())

    def close(self, topic: str) -> None:
        """Watch a topic no longer."""
        self._topics.pop(topic, None)

    def moving(self, topic: str, now_ns: int) -> None:
        """Note a command to move."""
        watched = self._topics.get(topic)
        if watched is not None:
            watched.is_moving = True
            watched.heard_ns = now_ns
            watched.zeros_left = 0

    def rest(self, topic: str) -> None:
        """Note that the gateway has stopped a topic itself."""
        watched = self._topics.get(topic)
        if watched is not None:
            watched.is_moving = False

    def silent(self, now_ns: int) -> list[str]:
        """Begin to stop the topics that move although the gateway was silent for too long."""
        late = [
            topic
            for topic, each in self._topics.items()
            if each.is_moving and now_ns - each.heard_ns >= self._silence_ns
        ]
        for topic in late:
            self._begin(self._topics[topic], now_ns)
        return late

    def lost(self, now_ns: int) -> None:
        """Begin to stop everything that moves: the gateway is gone."""
        for each in self._topics.values():
            if each.is_moving:
                self._begin(each, now_ns)

    def zeros(self, now_ns: int, is_heard: Callable[[str], bool]) -> list[str]:
        """Return the topics with a zero due now. *is_heard* says if all listeners hear it."""
        due = [
            topic
            for topic, each in self._topics.items()
            if each.zeros_left and now_ns >= each.next_zero_ns
        ]
        for topic in due:
            each = self._topics[topic]
            each.next_zero_ns = now_ns + ZERO_PERIOD_NS
            if is_heard(topic) or now_ns - each.began_ns >= UNHEARD_NS:
                each.zeros_left -= 1
        return due

    def _begin(self, watched: _Watched, now_ns: int) -> None:
        watched.is_moving = False
        watched.zeros_left = ZEROS
        watched.next_zero_ns = watched.began_ns = now_ns
