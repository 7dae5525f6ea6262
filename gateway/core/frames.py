# SPDX-License-Identifier: Apache-2.0
"""The framing of topics by a front: the content that it gets, and the frames that it makes."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from struct import pack
from typing import Literal, Protocol

from gateway.codec.cdr import Encoder
from gateway.codec.chunks import Chunks
from gateway.codec.cloud import CLOUD
from gateway.codec.nonfinite import NonFinite
from gateway.codec.picture import COMPRESSED_IMAGE
from gateway.codec.picture_message import PictureMessage
from gateway.codec.types import Types

Content = Literal["json", "cbor", "cdr"]
"""The forms in which the core gives messages to a front."""


@dataclass(frozen=True, slots=True)
class Meta:
    """Data about a sample, for a client that asks for them."""

    seq: int
    received_ns: int
    size: int  # of the sample, in bytes as CDR
    dropped: int
    quality: int | None = None  # of a picture that fits the link


@dataclass(frozen=True, slots=True)
class PerClient:
    """The difference between one subscription's frame and the frame that the others share."""

    seq: int  # of the sample
    framing: "Framing"  # as the subscription asks for
    meta: Meta | None = None
    is_ascii: bool = False


class PublishFrames(Protocol):
    """Makes the frames of one topic from encoded messages."""

    def shared(self, message: bytes) -> bytes:
        """Return the frame that all subscribers get who want nothing special."""

    def message(self, shared: bytes) -> bytes:
        """Return the message in a shared frame."""

    def per_client(self, message: bytes, own: PerClient) -> bytes:
        """Return the frame, or frames in a row, that one subscriber gets."""

    def shared_chunks(self, message: Chunks) -> Chunks:
        """Return the shared frame of a large message, which is not copied."""

    def per_client_chunks(self, message: Chunks, own: PerClient) -> bytes | Chunks:
        """Return the frame, or frames in a row, of a large message for one subscriber."""


@dataclass(frozen=True, kw_only=True)
class Framing(ABC):
    """The way in which a front sends the messages of a subscription. Equal ones share bytes.

    The subclass of a front may have more fields. If one does not change what is shared, leave it
    out of the comparison.
    """

    content: Content = "json"
    nonfinite: NonFinite | None = field(default=None, compare=False)  # of JSON. None: as null
    warning: str = field(default="", compare=False)  # about a wish that is not granted

    @property
    def name(self) -> str:
        """The word for it that the client knows."""
        return self.content

    @property
    def needs_own_frames(self) -> bool:
        """True if no frame can be shared with other subscriptions."""
        return False

    @property
    def is_packed(self) -> bool:
        """True if `pack` makes the message, which takes a worker."""
        return False

    def after(self, older: "Framing") -> "Framing":
        """Return what serves this request of a client and an *older* one for the same topic."""
        del older
        return self

    @abstractmethod
    def frames(self, topic: str) -> PublishFrames:
        """Return what makes the frames of a topic. *topic* is its name as requested."""

    def picture(self, picture: PictureMessage) -> bytes:
        """Return the message for a picture. Runs in any thread."""
        return picture.cbor() if self.content == "cbor" else picture.json()

    def before_cdr(self, now_ns: int, size: int) -> bytes:
        """Return what a message has before its CDR of so many bytes. *now_ns* is ROS time."""
        del now_ns, size
        return b""

    def pack(
        self, topic: str, message: Iterable[bytes], pause: Callable[[], None] | None = None
    ) -> bytes:
        """Return the message to send instead of one in JSON. Runs in any thread.

        The *message* comes in pieces. Call *pause* between them, if there is one.
        """
        raise NotImplementedError


class Unframed:
    """Frames nothing: what comes from the core goes on as it is."""

    def shared(self, message: bytes) -> bytes:
        """Return the message."""
        return message

    message = shared

    def per_client(self, message: bytes, _: PerClient) -> bytes:
        """Return the message."""
        return message

    def shared_chunks(self, message: Chunks) -> Chunks:
        """Return the message."""
        return message

    def per_client_chunks(self, message: Chunks, _: PerClient) -> Chunks:
        """Return the message."""
        return message


@dataclass(frozen=True, kw_only=True)
class PlainFraming(Framing):
    """Takes samples as they are. A picture or a thinned cloud becomes CDR again by *encode*."""

    content: Content = "cdr"
    encode: Encoder | None = field(default=None, compare=False)

    @classmethod
    def of_pictures(cls, types: Types) -> "PlainFraming":
        """Return the framing of cameras."""
        return cls(content="json", encode=types.get(COMPRESSED_IMAGE).compiled_encoder)

    @classmethod
    def of_clouds(cls, types: Types) -> "PlainFraming":
        """Return the framing of clouds that stay clouds."""
        return cls(content="json", encode=types.get(CLOUD).compiled_encoder)

    def frames(self, topic: str) -> Unframed:
        """Return what frames nothing."""
        del topic
        return Unframed()

    def picture(self, picture: PictureMessage) -> bytes:
        """Return the CDR, in which the bytes come last, after their number."""
        assert self.encode is not None  # noqa: S101  # else there are no pictures
        members, data = picture.members, picture.data
        if "point_step" in members:  # of a cloud, a boolean follows
            plain = self.encode({**members, "data": []}, 0)
            return b"".join((plain[:-5], pack("<I", len(data)), data, plain[-1:]))
        without_data = self.encode({name: members[name] for name in ("header", "format")}, 0)
        return b"".join((without_data[:-4], pack("<I", len(data)), data))
