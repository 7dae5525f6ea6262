# SPDX-License-Identifier: Apache-2.0
"""Encodings of a topic: each sample becomes bytes once, for all subscriptions with equal options.

Samples are encoded when a frame's turn on some socket has come: a sample that is dropped before was
never decoded.
"""

import asyncio
import logging
from collections.abc import Callable
from concurrent.futures import Executor
from typing import Final

from gateway.codec.cdr import Cdr
from gateway.codec.chunks import Chunks
from gateway.codec.error_text import CodecError
from gateway.codec.nonfinite import writer
from gateway.codec.types import MessageType
from gateway.core.entries import NOT_READY, NOTHING, Frame, NoFrame
from gateway.core.frames import Meta, PerClient
from gateway.core.topics.large_samples import LARGE_SAMPLE_BYTES, EncodedTopic, LargeSamples
from gateway.core.topics.subscription import EncodingKey, Subscription
from gateway.sources.source import Sample

logger = logging.getLogger(__name__)

Encode = Callable[[Cdr], bytes]
"""From CDR to a message as it stands in a frame. Raises `CodecError`."""

_ENCODED: Final = Sample(b"", 0)


class Encoding:
    """Encodes on the event loop, at the moment a frame is wanted. *large* samples in slices.

    *on_error* hears of samples that cannot be encoded.
    """

    def __init__(
        self,
        key: EncodingKey,
        encode: Encode,
        on_error: Callable[[CodecError], None],
        large: LargeSamples | None = None,
        most_at_once: int = LARGE_SAMPLE_BYTES,
    ) -> None:
        """Samples of more bytes than *most_at_once* are large."""
        self.subscriptions: list[Subscription] = []
        self.image = key.image
        self.frames = key.framing.frames(key.requested_name)
        self._encode = encode
        self._on_error = on_error
        self._large = large
        self._most_at_once = most_at_once

    def is_encoding(self, shared: "SharedFrame") -> bool:
        """Return whether this sample is being encoded right now."""
        return self._large is not None and self._large.is_encoding(shared)

    def encode(self, shared: "SharedFrame") -> Frame:
        """Return a sample as a message that a frame can hold, or why it cannot be one."""
        if shared.size > self._most_at_once and self._large is not None:
            return self._large.encode(shared)
        try:
            return self._encode(shared.sample.cdr)
        except CodecError as error:
            self._on_error(error)
            return NOTHING

    def close(self) -> None:
        """Keep nothing for late subscribers any more."""
        if self._large is not None:
            self._large.close()


class WorkerEncoding(Encoding):
    """Encodes in a worker thread: a picture takes milliseconds, and OpenCV releases the GIL.

    At most one sample is being encoded. A caller that wants another one asks again after *on_ready*
    was called, and by then a newer one may wait in its place.
    """

    def __init__(
        self,
        key: EncodingKey,
        encode: Encode,
        on_error: Callable[[CodecError], None],
        topic: EncodedTopic,
        workers: Executor,
        on_close: Callable[[], None] = lambda: None,
    ) -> None:
        super().__init__(key, encode, on_error)
        self._topic = topic
        self._workers = workers
        self._on_close = on_close
        self._busy_with: SharedFrame | None = None

    def close(self) -> None:
        """Share nothing with other encodings any more."""
        self._on_close()

    def is_encoding(self, shared: "SharedFrame") -> bool:
        """Return whether a worker encodes this sample right now."""
        return self._busy_with is shared

    def encode(self, shared: "SharedFrame") -> Frame:
        """Start to encode unless another sample is being encoded. Never ready at once."""
        if self._busy_with is None:
            self._busy_with = shared
            loop = asyncio.get_running_loop()
            future = loop.run_in_executor(self._workers, self._encode, shared.sample.cdr)
            future.add_done_callback(lambda done: self._finish(shared, done))
        return NOT_READY

    def _finish(self, shared: "SharedFrame", done: asyncio.Future[bytes]) -> None:
        self._busy_with = None
        if done.cancelled():
            return
        error = done.exception()
        if error is None:
            shared.supply(done.result())
        else:
            if isinstance(error, CodecError):
                self._on_error(error)
            else:
                extra = {"topic": self._topic.name}
                logger.error("encoding a sample failed", exc_info=error, extra=extra)
            shared.supply(NOTHING)
        self._topic.on_ready()


class SharedFrame:
    """One sample in one encoding: an entry that many queues share.

    It holds the sample first, then the encoded message, then the frame, once a subscription took it
    that shares frames. The message and the frame of a large sample are the same pieces. `size` is
    always that of the sample, though the JSON may be larger. `uint8[]` grows by a third,
    `float64[]` two and a half times, `bool[]` six times, and small messages by their names.
    """

    __slots__ = (
        "__weakref__",
        "_frame",
        "_message",
        "arrived_ns",
        "encoding",
        "sample",
        "seq",
        "size",
    )

    def __init__(self, encoding: Encoding, sample: Sample, seq: int) -> None:
        self.encoding = encoding
        self.sample = sample  # an empty one once it is encoded
        self.arrived_ns = sample.received_ns
        self.seq = seq
        self.size = len(sample.cdr)
        self._message: Frame = NOT_READY
        self._frame: bytes | Chunks | None = None

    @property
    def is_being_encoded(self) -> bool:
        """True while this sample is being encoded."""
        return self.encoding.is_encoding(self)

    def frame(self) -> Frame:
        """Return the frame that all subscriptions share."""
        if self._frame is None:
            message = self.message()
            if isinstance(message, bytes):
                self._frame = self.encoding.frames.shared(message)
                self._message = NOT_READY
            elif isinstance(message, Chunks):
                self._frame = self.encoding.frames.shared_chunks(message)
            else:
                return message
        return self._frame

    def message(self) -> Frame:
        """Return the message alone, for frames that are not shared."""
        if isinstance(self._frame, bytes):
            return self.encoding.frames.message(self._frame)
        if self._message is NOT_READY:
            message = self.encoding.encode(self)
            if message is NOT_READY:
                return message
            self._message = message
            self.sample = _ENCODED
        return self._message

    def supply(self, message: Frame) -> None:
        """Take the message, or `NOTHING`."""
        self._message = message
        self.sample = _ENCODED


class PerClientFrame:
    """A sample as one subscription alone gets it: with meta, in fragments, or in ASCII."""

    __slots__ = ("_received_ns", "_shared", "_subscription", "size")

    def __init__(
        self, shared: SharedFrame, subscription: Subscription, received_ns: int | None
    ) -> None:
        """*received_ns* is ROS time, ``None`` if the subscription had no meta when it came."""
        self._shared = shared
        self._subscription = subscription
        self._received_ns = received_ns
        self.size = shared.size

    @property
    def sample(self) -> Sample:
        """The sample, which is empty once it is encoded."""
        return self._shared.sample

    @property
    def arrived_ns(self) -> int:
        """The time at which DDS had the sample."""
        return self._shared.arrived_ns

    @property
    def is_being_encoded(self) -> bool:
        """True while the sample is being encoded."""
        return self._shared.is_being_encoded

    def frame(self) -> Frame:
        """Return the frame, or frames in a row, of this subscription."""
        shared, subscription = self._shared, self._subscription
        message = shared.message()
        if isinstance(message, NoFrame):
            return message
        options = subscription.options
        meta = None
        if options.meta and self._received_ns is not None:
            image = shared.encoding.image if subscription.follows_link else None
            quality = None if image is None else image.quality
            meta = Meta(shared.seq, self._received_ns, shared.size, subscription.lost, quality)
        own = PerClient(shared.seq, options.framing, meta, subscription.session.reads_ascii_only)
        if isinstance(message, Chunks):
            return shared.encoding.frames.per_client_chunks(message, own)
        return shared.encoding.frames.per_client(message, own)


def to_json(message_type: MessageType, key: EncodingKey) -> Encode:
    """Return what makes JSON of a small sample."""
    decode = message_type.decoder(key.fields)
    write = writer(key.nonfinite)
    return lambda cdr: write(decode(cdr))
