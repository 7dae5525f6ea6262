# SPDX-License-Identifier: Apache-2.0
"""The messages that wait for the disk, within a number and bytes."""

import threading
from collections import deque
from operator import itemgetter
from typing import Final

from gateway.recording.entries import RecordedMessage, RecordedTopic

# Small messages take 300 bytes and more of memory each, which the bytes do not count.
MAX_WAITING: Final = 100_000


class _Topic:
    __slots__ = ("dropped", "messages", "size")

    def __init__(self) -> None:
        self.messages: deque[RecordedMessage] = deque()
        self.size = 0
        self.dropped = 0


class WaitingMessages:
    """A queue from the event loop to a thread.

    When it is full, the topic that has most bytes loses its oldest message: a camera cannot push
    out odometry. Messages that were taken count until they are `written`.
    """

    def __init__(self, max_bytes: int) -> None:
        self._max_bytes = max_bytes
        self._lock = threading.Lock()
        self._topics: dict[RecordedTopic, _Topic] = {}
        self.size = 0
        self._count = 0

    def put(self, message: RecordedMessage) -> None:
        """Append a message. The loop's thread calls this."""
        size = len(message.cdr)
        with self._lock:
            topic = self._topics.get(message.topic)
            if topic is None:
                topic = self._topics[message.topic] = _Topic()
            topic.messages.append(message)
            topic.size += size
            self.size += size
            self._count += 1
            while self.size > self._max_bytes or self._count > MAX_WAITING:
                self._drop()

    def take(self) -> list[RecordedMessage]:
        """Take all messages, in the order in which they came. The thread calls this."""
        taken: list[RecordedMessage] = []
        with self._lock:
            for topic in self._topics.values():
                taken += topic.messages
                topic.messages.clear()
                topic.size = 0
        taken.sort(key=itemgetter(0))
        return taken

    def written(self, count: int, size: int) -> None:
        """Make room again for messages that were taken. The thread calls this."""
        with self._lock:
            self._count -= count
            self.size -= size

    def dropped(self) -> dict[str, int]:
        """Return the number of messages that each topic has lost, if any."""
        with self._lock:
            return {key.name: each.dropped for key, each in self._topics.items() if each.dropped}

    def _drop(self) -> None:
        topic = max(self._topics.values(), key=lambda each: (each.size, len(each.messages)))
        size = len(topic.messages.popleft().cdr)
        topic.size -= size
        topic.dropped += 1
        self.size -= size
        self._count -= 1
