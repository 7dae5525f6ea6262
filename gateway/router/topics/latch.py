# SPDX-License-Identifier: Apache-2.0
"""The samples that a transient-local topic keeps for later clients."""

import logging
from collections import deque
from collections.abc import Sequence
from typing import Any, Final

from gateway.codec.errors import CodecError
from gateway.codec.json import dumps, loads
from gateway.codec.types import MessageType
from gateway.ports import Sample
from gateway.tf import TF_MESSAGE
from gateway.tf.buffer import MAX_FRAME_CHARACTERS, MAX_FRAMES

# Two maps of a large building; of bigger messages, only the newest one is kept.
MAX_BYTES: Final = 8 * 1024**2
_MAX_SEC: Final = 2**31 - 1

logger = logging.getLogger(__name__)


class Latch:
    """The newest samples of a topic with their numbers, within `MAX_BYTES`; one always fits."""

    def __init__(self) -> None:
        self._kept: deque[tuple[int, Sample]] = deque()
        self._size = 0

    def keep(self, samples: Sequence[Sample], first_seq: int, count: int) -> None:
        """Add samples, numbered from *first_seq*; keep *count* in all."""
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
        """Forget all samples."""
        self._kept.clear()
        self._size = 0


class TransformLatch:
    """The newest transform of each child frame, from all publishers, as one message.

    It replaces `Latch` on ``/tf_static``: the transforms in several messages of one publisher, and
    those of several publishers, all remain valid. It keeps at most as many frames as a transform
    buffer, and none with names too long for it, so that they fit into 1.1 MB; the frame that was
    published longest ago makes room.
    """

    def __init__(self, message_type: MessageType) -> None:
        self._type = message_type
        self._transforms: dict[str, Any] = {}
        self._newest: tuple[int, Sample] | None = None
        self._is_merged = False

    def keep(self, samples: Sequence[Sample], first_seq: int, count: int) -> None:
        """Add samples, numbered from *first_seq*; *count* does not matter."""
        del count
        for seq, sample in enumerate(samples, start=first_seq):
            try:
                message: Any = self._type.decode(sample.cdr)
            except CodecError:
                continue  # its subscribers are warned of it
            for transform in message["transforms"]:
                self._put(transform)
            self._newest = seq, sample
            self._is_merged = False

    def newest(self, count: int) -> list[tuple[int, Sample]]:
        """Return the one message, with number and time of its newest transform.

        Infinities become NaN: neither is a position.
        """
        if self._newest is None or not count:
            return []
        if not self._is_merged:
            self._is_merged = True
            seq, sample = self._newest
            try:
                self._newest = seq, sample._replace(cdr=self._merged(sample.received_ns))
            except CodecError as error:
                logger.warning("%s: %s; the latest goes out alone", self._type.name, error)
        return [self._newest]

    def clear(self) -> None:
        """Forget all samples."""
        self._transforms.clear()
        self._newest = None

    def _put(self, transform: dict[str, Any]) -> None:
        header, child = transform["header"], transform["child_frame_id"]
        if max(len(child), len(header["frame_id"])) > MAX_FRAME_CHARACTERS:
            return
        stamp = header["stamp"]
        # a message holds any value, but validation requires less than a second
        sec, stamp["nanosec"] = divmod(stamp["nanosec"], 1_000_000_000)
        stamp["sec"] = min(stamp["sec"] + sec, _MAX_SEC)
        self._transforms.pop(child, None)
        self._transforms[child] = transform
        if len(self._transforms) > MAX_FRAMES:
            del self._transforms[next(iter(self._transforms))]

    def _merged(self, now_ns: int) -> bytes:
        # in the form that clients send: NaN as null
        values = loads(dumps({"transforms": list(self._transforms.values())}))
        return self._type.encode(values, now_ns)


def make_latch(topic: str, message_type: MessageType) -> Latch | TransformLatch:
    """Return the latch for the samples of a topic."""
    is_tf_static = topic.endswith("/tf_static") and message_type.name == TF_MESSAGE
    return TransformLatch(message_type) if is_tf_static else Latch()
