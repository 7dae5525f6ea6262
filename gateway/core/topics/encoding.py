# SPDX-License-Identifier: Apache-2.0
"""Encodings of a topic: each sample becomes bytes once, for all subscriptions with equal options.

Samples are encoded when a frame's turn on some socket has come: a sample that is dropped before was
never decoded.
"""

import asyncio
import logging
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from typing import Final

from gateway.codec import cbor
from gateway.codec.cdr import Cdr
from gateway.codec.chunks import Chunk, Chunks
from gateway.codec.errors import CodecError
from gateway.codec.grid_picture import GRID, cbor_grid_renderer, grid_renderer
from gateway.codec.json_slices import json_slices
from gateway.codec.nonfinite import writer
from gateway.codec.picture import cbor_picture_renderer, picture_renderer
from gateway.codec.png import large_text_as_png, text_as_png
from gateway.codec.types import MessageType
from gateway.core.entries import NOT_READY, NOTHING, Frame, NoFrame
from gateway.core.frames import Meta, PerClient
from gateway.core.topics.large_samples import (
    LARGE_ELEMENTS_BYTES,
    LARGE_SAMPLE_BYTES,
    EncodedTopic,
    EncodeInSlices,
    EncodingResources,
    LargeSamples,
)
from gateway.core.topics.subscription import EncodingKey, Subscription
from gateway.sources.source import Sample

logger = logging.getLogger(__name__)

Encode = Callable[[Cdr], bytes]
"""From CDR to a message as it stands in a frame. Raises `CodecError`."""

# Between slices of a worker. A sleep of 0 gives the GIL back, and takes it before others wake up.
PAUSE_S: Final = 0.0001

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
        self.frames = key.framing.frames(key.requested_name, key.compression)
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
        *,
        topic: str,
        on_ready: Callable[[], None],
        workers: Executor,
    ) -> None:
        """*topic* is the resolved name, for the log."""
        super().__init__(key, encode, on_error)
        self._topic = topic
        self._on_ready = on_ready
        self._workers = workers
        self._busy_with: SharedFrame | None = None

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
                extra = {"topic": self._topic}
                logger.error("encoding a sample failed", exc_info=error, extra=extra)
            shared.supply(NOTHING)
        self._on_ready()


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
        own = PerClient(
            shared.seq, meta, options.fragment_size, subscription.session.reads_ascii_only
        )
        if isinstance(message, Chunks):
            return shared.encoding.frames.per_client_chunks(message, own)
        return shared.encoding.frames.per_client(message, own)


def make_encoding(
    message_type: MessageType,
    key: EncodingKey,
    topic: EncodedTopic,
    on_error: Callable[[CodecError], None],
    resources: EncodingResources,
) -> Encoding:
    """Return the encoding that a key asks for. *on_error* hears of samples that have no message."""
    if key.fields == ():
        return Encoding(key, _nothing_of_it(key), on_error)
    match key.compression:
        case "none":
            encode = _to_json(message_type, key)
            in_slices = _to_json_slices(message_type, key)
        case "png":
            encode = _to_png(message_type, key)
        case "cbor":
            encode = _to_cbor(message_type, key)
            in_slices = _to_cbor_slices(message_type, key)
        case "cbor-raw":
            encode = _to_raw_cbor(topic.now_ns)
            in_slices = _to_raw_cbor_slices(topic.now_ns)
    if key.image is None and key.compression != "png":
        large = LargeSamples(in_slices, on_error, topic, resources)
        has_elements = message_type.holds_elements and key.compression != "cbor-raw"
        most_at_once = LARGE_ELEMENTS_BYTES if has_elements else LARGE_SAMPLE_BYTES
        return Encoding(key, encode, on_error, large, most_at_once)
    return WorkerEncoding(
        key,
        encode,
        on_error,
        topic=topic.name,
        on_ready=topic.on_ready,
        workers=resources.workers,
    )


def _nothing_of_it(key: EncodingKey) -> Encode:
    """Decode nothing: a client that asks for no fields wants to know that samples come."""
    match key.compression:
        case "none":
            message = b"{}"
        case "png":
            message = text_as_png(b"".join(key.framing.text(key.requested_name, (b"{}",))))
        case "cbor" | "cbor-raw":  # with the latter, fields are refused before
            message = cbor.head(cbor.MAP, 0)
    return lambda _: message


def _to_json(message_type: MessageType, key: EncodingKey) -> Encode:
    if key.image is not None and message_type.name == GRID:
        return grid_renderer(message_type)
    if key.image is not None:
        return picture_renderer(message_type, key.image)
    decode = message_type.decoder(key.fields)
    write = writer(key.nonfinite)
    return lambda cdr: write(decode(cdr))


def _to_json_slices(message_type: MessageType, key: EncodingKey) -> EncodeInSlices:
    write = writer(key.nonfinite)

    def encode(cdr: Cdr) -> Iterator[Chunk]:
        # compiled when the first large sample has come
        value = yield from message_type.sliced_decoder(key.fields)(cdr, write)
        yield from json_slices(value, write)

    return encode


def _to_cbor(message_type: MessageType, key: EncodingKey) -> Encode:
    if key.image is not None and message_type.name == GRID:
        return cbor_grid_renderer(message_type)
    if key.image is not None:
        return cbor_picture_renderer(message_type, key.image)
    return message_type.transcoder(key.fields)


def _to_cbor_slices(message_type: MessageType, key: EncodingKey) -> EncodeInSlices:
    def encode(cdr: Cdr) -> Iterator[Chunk]:
        yield from (yield from message_type.sliced_transcoder(key.fields)(cdr))

    return encode


def _to_raw_cbor(now_ns: Callable[[], int]) -> Encode:
    return lambda cdr: b"".join((_up_to_bytes(now_ns(), len(cdr)), cdr))


def _to_raw_cbor_slices(now_ns: Callable[[], int]) -> EncodeInSlices:
    return lambda cdr: iter((_up_to_bytes(now_ns(), len(cdr)), cdr))


def _up_to_bytes(now_ns: int, size: int) -> bytes:
    """Return the message of `cbor-raw` up to its last member, the CDR."""
    secs, nsecs = divmod(now_ns, 1_000_000_000)
    members = {"secs": secs, "nsecs": nsecs}
    items = [cbor.text(name) + cbor.dumps(value) for name, value in members.items()]
    # the map has one member more, and its items just follow each other
    head = cbor.head(cbor.MAP, len(members) + 1)
    return b"".join((head, *items, cbor.text("bytes"), cbor.head(cbor.OCTETS, size)))


def _to_png(message_type: MessageType, key: EncodingKey) -> Encode:
    """Return the function for a worker."""
    to_json = _to_json(message_type, key)
    text, topic = key.framing.text, key.requested_name

    def encode(cdr: Cdr) -> bytes:
        return text_as_png(b"".join(text(topic, (to_json(cdr),))))

    if key.image is not None or not message_type.may_be_large:
        return encode
    decode = message_type.sliced_decoder(key.fields)  # now: it is not compiled in a worker
    write = writer(key.nonfinite)

    def message(cdr: Cdr) -> Iterator[bytes]:
        value = yield from decode(cdr, write)
        yield from map(bytes, json_slices(value, write))

    def encode_any(cdr: Cdr) -> bytes:
        if len(cdr) <= LARGE_SAMPLE_BYTES:
            return encode(cdr)
        return large_text_as_png(text(topic, message(cdr)), _let_others_run)

    return encode_any


def _let_others_run() -> None:
    """Give the GIL to the event loop, which else waits for 5 ms (`sys.getswitchinterval`)."""
    time.sleep(PAUSE_S)
