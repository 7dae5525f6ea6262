# SPDX-License-Identifier: Apache-2.0
"""The interface of a file with recorded messages. Each format has a module that implements it."""

from collections import deque
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import Final, Generic, NamedTuple, Protocol, TypeVar

import zstandard

from gateway.codec.cdr import Cdr
from gateway.sources.source import Qos
from schemas.definition import Definition

# Several nodes publish static transforms, and each message has some of them.
TF_STATIC: Final = "/tf_static"
# of one latched topic, for late subscribers and after a jump
MAX_HELD: Final = 100
MAX_HELD_BYTES: Final = 32 * 1024 * 1024

ZSTD_MAGIC: Final = b"\x28\xb5\x2f\xfd"

DEFAULT_QOS: Final = Qos("reliable", "volatile", "keep_last", 10)


Stream = tuple[str, str]
"""A topic and its type."""


@dataclass(frozen=True, eq=False)
class Track:
    """The messages of one topic and type in one file."""

    topic: str
    type_name: str
    qos: Qos = DEFAULT_QOS
    """The offers of all publishers of the recorded robot, taken together."""

    @property
    def stream(self) -> Stream:
        """The topic and the type."""
        return self.topic, self.type_name

    @property
    def is_latched(self) -> bool:
        """True if subscribers get the last messages from before they came."""
        return self.qos.durability == "transient_local"

    @property
    def held(self) -> int:
        """The number of messages that late subscribers get."""
        if not self.is_latched:
            return 0
        return MAX_HELD if self.topic == TF_STATIC else min(self.qos.depth or 1, MAX_HELD)


class Recorded(NamedTuple):
    """One message of a recording, as CDR."""

    time_ns: int
    track: Track
    cdr: bytes


def uncompressed(message: bytes) -> bytes:
    """Return CDR, which begins with a zero, of a message that rosbag2 may have compressed."""
    return zstandard.decompress(message) if message.startswith(ZSTD_MAGIC) else message


class HasCdr(Protocol):
    """Something with the bytes of a message."""

    @property
    def cdr(self) -> Cdr:
        """The message."""


Kept = TypeVar("Kept", bound=HasCdr)


class NewestMessages(Generic[Kept]):
    """The last messages, bounded in number and in bytes. The newest one always fits."""

    def __init__(self, most: int) -> None:
        self.messages: deque[Kept] = deque()
        self._most = most
        self._size = 0

    def add(self, message: Kept) -> None:
        """Keep a message, and forget the oldest ones that are too many."""
        self.messages.append(message)
        self._size += len(message.cdr)
        while len(self.messages) > max(self._most, 1) or (
            self._size > MAX_HELD_BYTES and len(self.messages) > 1
        ):
            self._size -= len(self.messages.popleft().cdr)


class RecordedFile(Protocol):
    """An open file. One thread at a time uses it."""

    @property
    def tracks(self) -> Collection[Track]:
        """All that can be played."""

    @property
    def definitions(self) -> Mapping[str, Definition]:
        """The message types that the file defines."""

    @property
    def skipped(self) -> Mapping[str, str]:
        """Topics that cannot be played, and the reasons."""

    @property
    def start_ns(self) -> int:
        """The time of the first message. With no message, it is not before `end_ns`."""

    @property
    def end_ns(self) -> int:
        """The time right behind the last message."""

    def messages(
        self, tracks: Collection[Track], start_ns: int, stop_ns: int
    ) -> Iterator[Recorded]:
        """Yield the messages of *tracks* with start <= time < stop, ordered by time.

        Raises:
            Exception: whatever the library raises where the file is damaged.
        """

    def close(self) -> None:
        """Close the file."""
