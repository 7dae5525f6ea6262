# SPDX-License-Identifier: Apache-2.0
"""What a transient-local topic keeps for clients that come later."""

from collections import deque
from collections.abc import Sequence
from typing import Any, Final

from gateway.codec.errors import CodecError
from gateway.codec.json import dumps, loads
from gateway.codec.types import MessageType
from gateway.ports import Sample
from gateway.router.tf_listener import TF_MESSAGE
from gateway.tf.buffer import MAX_FRAMES

# Two maps of a large building; of bigger messages the newest one alone is kept.
MAX_BYTES: Final = 8 * 1024**2


class Latch:
    """The newest samples of a topic with their numbers, within `MAX_BYTES`; one always fits."""

    def __init__(self) -> None:
        self._kept: deque[tuple[int, Sample]] = deque()
        self._size = 0

    def keep(self, samples: Sequence[Sample], first_seq: int, count: int) -> None:
        """Add samples, the first of which has number *first_seq*; keep *count* in all."""
        for seq, sample in enumerate(samples, start=first_seq):
            self._kept.append((seq, sample))
            self._size += len(sample.cdr)
        while len(self._kept) > count or (self._size > MAX_BYTES and len(self._kept) > 1):
            _, dropped = self._kept.popleft()
            self._size -= len(dropped.cdr)

    def newest(self, count: int) -> list[tuple[int, Sample]]:
        """Return the newest samples with their numbers, oldest first."""
        return list(self._kept)[-count:]

    def clear(self) -> None:
        """Forget all: the topic keeps nothing any more."""
        self._kept.clear()
        self._size = 0


class TransformLatch:
    """The newest transform of each child frame, whoever published it, as one message.

    It stands in for `Latch` on ``/tf_static``: what one publisher said in several messages, and
    what several publishers said, all of it still holds. At most as many frames are kept as a
    transform buffer has; the one that was said longest ago makes room.
    """

    def __init__(self, message_type: MessageType) -> None:
        self._type = message_type
        self._transforms: dict[str, Any] = {}
        self._newest: tuple[int, Sample] | None = None
        self._is_merged = False

    def keep(self, samples: Sequence[Sample], first_seq: int, count: int) -> None:
        """Add samples, the first of which has number *first_seq*; *count* does not matter."""
        del count
        for seq, sample in enumerate(samples, start=first_seq):
            try:
                message: Any = self._type.decode(sample.cdr)
            except CodecError:
                continue  # those who are subscribed hear of it
            for transform in message["transforms"]:
                child = transform["child_frame_id"]
                self._transforms.pop(child, None)
                self._transforms[child] = transform
                if len(self._transforms) > MAX_FRAMES:
                    del self._transforms[next(iter(self._transforms))]
            self._newest = seq, sample
            self._is_merged = False

    def newest(self, count: int) -> list[tuple[int, Sample]]:
        """Return the one message, with number and time of the newest that is part of it."""
        if self._newest is None or not count:
            return []
        if not self._is_merged:
            seq, sample = self._newest
            # as a client would send it back: NaN as null
            values = loads(dumps({"transforms": list(self._transforms.values())}))
            cdr = self._type.encode(self._type.validate(values, sample.received_ns))
            self._newest = seq, sample._replace(cdr=cdr)
            self._is_merged = True
        return [self._newest]

    def clear(self) -> None:
        """Forget all: the topic keeps nothing any more."""
        self._transforms.clear()
        self._newest = None


def make_latch(topic: str, message_type: MessageType) -> Latch | TransformLatch:
    """Return what a topic's samples are kept in."""
    is_tf_static = topic.endswith("/tf_static") and message_type.name == TF_MESSAGE
    return TransformLatch(message_type) if is_tf_static else Latch()
