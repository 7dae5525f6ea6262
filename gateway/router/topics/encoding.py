# SPDX-License-Identifier: Apache-2.0
"""Encodings of a topic: each sample becomes bytes once, for all subscriptions with equal options.

Samples are encoded when a frame's turn on some socket has come: a sample that is dropped before was
never decoded.
"""

import asyncio
import logging
from collections.abc import Callable
from concurrent.futures import Executor

from gateway.codec import cbor
from gateway.codec.errors import CodecError
from gateway.codec.json import ascii_only
from gateway.codec.nonfinite import writer
from gateway.codec.picture import cbor_picture_renderer, picture_renderer
from gateway.codec.png import text_as_png
from gateway.codec.types import MessageType
from gateway.ports import Sample
from gateway.protocol import messages
from gateway.protocol.outbox import NOT_READY, NOTHING, Frame, NoFrame
from gateway.protocol.websocket_frames import Meta, PerClient, publish_frames
from gateway.router.topics.subscription import EncodingKey, Subscription

logger = logging.getLogger(__name__)

Encode = Callable[[bytes], bytes]
"""From CDR to a message as it stands in a frame; raises `CodecError`."""


class Encoding:
    """Encodes on the event loop, at the moment a frame is wanted.

    *on_error* hears of samples that cannot be encoded.
    """

    def __init__(
        self, key: EncodingKey, encode: Encode, on_error: Callable[[CodecError], None]
    ) -> None:
        self.subscriptions: list[Subscription] = []
        self.image = key.image
        self.frames = publish_frames(key.requested_name, key.compression)
        self._encode = encode
        self._on_error = on_error

    def is_encoding(self, shared: "SharedFrame") -> bool:
        """Return whether a worker encodes this sample right now."""
        del shared
        return False

    def encode(self, shared: "SharedFrame") -> Frame:
        """Return a sample as a message that a frame can hold, or why it cannot be one."""
        try:
            return self._encode(shared.cdr)
        except CodecError as error:
            self._on_error(error)
            return NOTHING


class WorkerEncoding(Encoding):
    """Encodes in a worker thread: a picture takes milliseconds, and OpenCV releases the GIL.

    At most one sample is being encoded. Whoever wants another one asks again after *on_ready* was
    called, and by then a newer one may wait in its place.
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
        """Start to encode unless another sample is being encoded; never ready at once."""
        if self._busy_with is None:
            self._busy_with = shared
            loop = asyncio.get_running_loop()
            future = loop.run_in_executor(self._workers, self._encode, shared.cdr)
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

    It holds one of three: the sample; once it is encoded, the message; once a subscription took it
    that shares frames, the frame. `size` is the sample's and stays so while others wait, though
    what they hold may by then be larger: as JSON `uint8[]` by a third, `float64[]` two and a half
    times, `bool[]` six times, small messages by their names.
    """

    __slots__ = ("_frame", "_message", "arrived_ns", "cdr", "encoding", "seq", "size")

    def __init__(self, encoding: Encoding, sample: Sample, seq: int) -> None:
        self.encoding = encoding
        self.cdr = sample.cdr  # empty once it is encoded
        self.arrived_ns = sample.received_ns
        self.seq = seq
        self.size = len(sample.cdr)
        self._message: Frame = NOT_READY
        self._frame: bytes | None = None

    @property
    def is_being_encoded(self) -> bool:
        """True while a worker encodes this sample."""
        return self.encoding.is_encoding(self)

    def frame(self) -> Frame:
        """Return the frame that all subscriptions share."""
        if self._frame is None:
            message = self.message()
            if isinstance(message, NoFrame):
                return message
            self._frame = self.encoding.frames.shared(message)
            self._message = NOT_READY
        return self._frame

    def message(self) -> Frame:
        """Return the message alone, for frames that are not shared."""
        if self._frame is not None:
            return self.encoding.frames.message(self._frame)
        if self._message is NOT_READY:
            message = self.encoding.encode(self)
            if message is NOT_READY:
                return message
            self._message = message
            self.cdr = b""
        return self._message

    def supply(self, message: Frame) -> None:
        """Take the message that a worker made, or `NOTHING`."""
        self._message = message
        self.cdr = b""


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
        """True while a worker encodes the sample."""
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
            meta = Meta(shared.seq, self._received_ns, subscription.lost, quality)
        own = PerClient(shared.seq, meta, options.fragment_size, subscription.session.is_ros_sharp)
        return shared.encoding.frames.per_client(message, own)


def make_encoding(
    message_type: MessageType,
    key: EncodingKey,
    *,
    topic: str,
    on_error: Callable[[CodecError], None],
    on_ready: Callable[[], None],
    now_ns: Callable[[], int],
    workers: Executor,
) -> Encoding:
    """Return the encoding that a key asks for; *workers* do what takes milliseconds.

    *topic* is the resolved name, for the log. *on_error* hears of samples that cannot be encoded,
    *on_ready* is called when a worker is done, *now_ns* is ROS time.
    """
    match key.compression:
        case "none":
            encode = _to_json(message_type, key)
        case "png":
            encode = _to_png(_to_json(message_type, key), key.requested_name)
        case "cbor":
            encode = _to_cbor(message_type, key)
        case "cbor-raw":
            encode = _to_raw_cbor(now_ns)
    if key.image is None and key.compression != "png":
        return Encoding(key, encode, on_error)
    return WorkerEncoding(key, encode, on_error, topic=topic, on_ready=on_ready, workers=workers)


def _to_json(message_type: MessageType, key: EncodingKey) -> Encode:
    if key.image is not None:
        return picture_renderer(message_type, key.image)
    decode = message_type.decoder(key.fields)
    write = writer(key.nonfinite)
    return lambda cdr: write(decode(cdr))


def _to_cbor(message_type: MessageType, key: EncodingKey) -> Encode:
    if key.image is not None:
        return cbor_picture_renderer(message_type, key.image)
    return message_type.transcoder(key.fields)


def _to_raw_cbor(now_ns: Callable[[], int]) -> Encode:
    def encode(cdr: bytes) -> bytes:
        secs, nsecs = divmod(now_ns(), 1_000_000_000)
        return cbor.dumps({"secs": secs, "nsecs": nsecs, "bytes": cdr})

    return encode


def _to_png(to_json: Encode, topic: str) -> Encode:
    prefix = messages.publish_prefix(topic)
    return lambda cdr: text_as_png(
        ascii_only(b"".join((prefix, to_json(cdr), messages.PUBLISH_SUFFIX)))
    )
