# SPDX-License-Identifier: Apache-2.0
"""Frames that are rendered once and shared by every client that asked for the same.

A rendition is what distinguishes frames of one topic: its spelling, the compression, the fields,
the image options. Rendering happens when a frame's turn on some socket has come, so what is dropped
before is never decoded.
"""

import asyncio
import logging
from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass

from gateway.codec.errors import CodecError
from gateway.codec.image import ImageOptions
from gateway.ports import Sample
from gateway.protocol.publish_frames import Compression, Envelope, Meta, Tailoring
from gateway.protocol.session import Session
from gateway.protocol.subscription_options import Stream

logger = logging.getLogger(__name__)

Render = Callable[[bytes], bytes]  # CDR -> what the envelope takes; raises CodecError


@dataclass(frozen=True, slots=True)
class RenditionKey:
    """What streams must have in common to share frames."""

    topic: str  # as the clients spell it
    fields: tuple[str, ...] | None
    image: ImageOptions | None  # None: a plain message
    compression: Compression = "none"


class Rendition:
    """Renders on the event loop, at the moment the bytes are wanted."""

    def __init__(
        self,
        key: RenditionKey,
        envelope: Envelope,
        render: Render,
        on_failure: Callable[[CodecError], None],
    ) -> None:
        self.key = key
        self.envelope = envelope
        self._render = render
        self._on_failure = on_failure

    def is_rendering(self, frame: "Frame") -> bool:
        """Whether a frame is being rendered elsewhere."""
        del frame
        return False

    def body(self, frame: "Frame") -> bytes | None:
        """Return the message for the envelope; ``None``: not yet; empty: it cannot be decoded."""
        try:
            return self._render(frame.cdr)
        except CodecError as error:
            self._on_failure(error)
            return b""


class ThreadedRendition(Rendition):
    """Renders in a worker thread: a picture takes milliseconds, and OpenCV releases the GIL.

    At most one picture is in the works; whoever wants another one asks again when *on_ready*
    says so, and by then a newer one may wait in its place.
    """

    def __init__(
        self,
        key: RenditionKey,
        envelope: Envelope,
        render: Render,
        on_failure: Callable[[CodecError], None],
        *,
        workers: Executor,
        on_ready: Callable[[], None],
    ) -> None:
        super().__init__(key, envelope, render, on_failure)
        self._workers = workers
        self._on_ready = on_ready
        self._in_work: Frame | None = None

    def is_rendering(self, frame: "Frame") -> bool:
        """Whether this very frame is in the works."""
        return self._in_work is frame

    def body(self, frame: "Frame") -> bytes | None:
        """Start to render unless another picture is in the works; never ready at once."""
        if self._in_work is None:
            self._in_work = frame
            loop = asyncio.get_running_loop()
            future = loop.run_in_executor(self._workers, self._render, frame.cdr)
            future.add_done_callback(lambda done: self._finish(frame, done))
        return None

    def _finish(self, frame: "Frame", done: asyncio.Future[bytes]) -> None:
        self._in_work = None
        if done.cancelled():
            return
        error = done.exception()
        if error is None:
            frame.resolve(done.result())
        else:
            if isinstance(error, CodecError):
                self._on_failure(error)
            else:
                logger.error("rendering %s failed", self.key.topic, exc_info=error)
            frame.resolve(b"")
        self._on_ready()


class Frame:
    """One sample in one rendition: an outbox entry that many outboxes share.

    It holds one of three: the sample; once it is rendered, the message for the envelope; once
    some stream took it that wants nothing special, the shared frame. `size` is the sample's and
    stays so while others wait, though what they hold may by then be larger: as JSON `uint8[]` by a
    third, `float64[]` two and a half times, `bool[]` six times, small messages by their names.
    """

    __slots__ = ("_body", "_wire", "cdr", "rendition", "seq", "size")

    def __init__(self, rendition: Rendition, sample: Sample, seq: int) -> None:
        self.rendition = rendition
        self.cdr = sample.cdr  # empty once it is rendered
        self.seq = seq
        self.size = len(sample.cdr)
        self._body: bytes | None = None
        self._wire: bytes | None = None

    @property
    def is_being_rendered(self) -> bool:
        """Whether work on it is under way."""
        return self.rendition.is_rendering(self)

    def wire(self) -> bytes | None:
        """Return the frame as all streams get it that want nothing special."""
        if self._wire is None:
            body = self.body()
            if not body:
                return body
            self._wire = self.rendition.envelope.shared(body)
            self._body = None
        return self._wire

    def body(self) -> bytes | None:
        """Return the message for the envelope; see `Rendition.body`."""
        if self._wire is not None:
            return self.rendition.envelope.body(self._wire)
        if self._body is None:
            body = self.rendition.body(self)
            if body is not None:
                self.resolve(body)
        return self._body

    def resolve(self, body: bytes) -> None:
        """Supply the message that was rendered elsewhere."""
        self._body = body
        self.cdr = b""


class TailoredFrame:
    """A frame as one stream alone gets it: with meta, in pieces, or in ASCII."""

    __slots__ = ("_frame", "_ros_time_ns", "_session", "_stream", "size")

    def __init__(self, frame: Frame, stream: Stream, session: Session, ros_time_ns: int) -> None:
        self._frame = frame
        self._stream = stream
        self._session = session
        self._ros_time_ns = ros_time_ns
        self.size = frame.size

    @property
    def is_being_rendered(self) -> bool:
        """Whether work on it is under way."""
        return self._frame.is_being_rendered

    def wire(self) -> bytes | None:
        """Return the frame, or frames in a row, as this stream alone gets it."""
        frame = self._frame
        body = frame.body()
        if not body:
            return body
        wish = self._stream.wish
        meta = None
        if wish.meta:
            meta = Meta(frame.seq, self._ros_time_ns, self._stream.queue.dropped)
        return frame.rendition.envelope.tailored(
            body, Tailoring(frame.seq, meta, wish.fragment_size, self._session.is_ros_sharp)
        )
