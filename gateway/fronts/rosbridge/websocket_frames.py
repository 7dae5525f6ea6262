# SPDX-License-Identifier: Apache-2.0
"""The WebSocket frames that the server sends (RFC 6455, section 5.2).

A message of a topic is framed once and its bytes are shared by all subscribers, which a WebSocket
library cannot do for us: it frames per connection. Frames from a server are not masked, and none
is fragmented or compressed, so a header depends on the payload's kind and length alone.
"""

import struct
from dataclasses import dataclass
from typing import Final, Literal, Protocol

import orjson

from gateway.codec import cbor
from gateway.codec.json import ascii_only
from gateway.codec.pieces import Pieces
from gateway.fronts.rosbridge import messages
from gateway.fronts.rosbridge.fragments import split

# the first byte of a complete frame: FIN, and the opcode
TEXT: Final = 0x81
BINARY: Final = 0x82

_SHORT: Final = 126  # a shorter length stands in the second byte itself
_LONG: Final = 1 << 16
_pack_short: Final = struct.Struct(">BB").pack
_pack_medium: Final = struct.Struct(">BBH").pack
_pack_long: Final = struct.Struct(">BBQ").pack

Compression = Literal["none", "png", "cbor", "cbor-raw"]
"""The form of messages on the wire: JSON, JSON in a picture, CBOR, or CDR in CBOR."""


def header(kind: int, length: int) -> bytes:
    """Return the header of a complete, unmasked frame of `TEXT` or `BINARY`.

    *length* is that of the payload in bytes.
    """
    if length < _SHORT:
        return _pack_short(kind, length)
    if length < _LONG:
        return _pack_medium(kind, 126, length)
    return _pack_long(kind, 127, length)


def payload(frame: bytes) -> bytes:
    """Take the payload out of a single frame of ours."""
    return frame[_payload_offset(frame) :]


def text_frame(payload: bytes) -> bytes:
    """Return a complete, unmasked text frame."""
    return header(TEXT, len(payload)) + payload


def text_frames(text: bytes, fragment_size: int | None, fragment_id: str) -> bytes:
    """Return the frames for a JSON text: one, or several in a row. See `split`."""
    if fragment_size is None:
        return text_frame(text)
    return b"".join(map(text_frame, split(text, fragment_size, fragment_id)))


@dataclass(frozen=True, slots=True)
class Meta:
    """The members that ``meta: true`` adds to a `publish` frame."""

    seq: int
    received_ns: int
    size: int  # of the sample, in bytes as CDR
    dropped: int
    quality: int | None = None  # of a picture that fits the link

    def members(self) -> dict[str, object]:
        """Return them by their names on the wire."""
        received = messages.time(self.received_ns)
        members: dict[str, object] = {
            "seq": self.seq,
            "received": received,
            "size": self.size,
            "dropped": self.dropped,
        }
        return members if self.quality is None else members | {"quality": self.quality}


@dataclass(frozen=True, slots=True)
class PerClient:
    """The difference between one subscription's frame and the frame that the others share."""

    seq: int  # of the sample
    meta: Meta | None = None
    fragment_size: int | None = None
    is_ascii: bool = False


class PublishFrames(Protocol):
    """Makes the frames of one topic, in one compression, from encoded messages."""

    def shared(self, message: bytes) -> bytes:
        """Return the frame that all subscribers get who want nothing special."""

    def message(self, shared: bytes) -> bytes:
        """Return the message in a shared frame."""

    def per_client(self, message: bytes, own: PerClient) -> bytes:
        """Return the frame, or frames in a row, that one subscriber gets."""

    def shared_pieces(self, message: Pieces) -> Pieces:
        """Return the shared frame of a large message, which is not copied."""

    def per_client_pieces(self, message: Pieces, own: PerClient) -> bytes | Pieces:
        """Return the frame, or frames in a row, of a large message for one subscriber."""


class JsonFrames:
    """Makes `publish` frames of messages in JSON."""

    def __init__(self, topic: str) -> None:
        self._topic = topic
        self._prefix = messages.publish_prefix(topic)

    def shared(self, message: bytes) -> bytes:
        """Frame a message without looking at it."""
        prefix = self._prefix
        length = len(prefix) + len(message) + 1
        return b"".join((header(TEXT, length), prefix, message, messages.PUBLISH_SUFFIX))

    def message(self, shared: bytes) -> bytes:
        """Take the message out of its frame."""
        return _after(self._prefix, shared)[: -len(messages.PUBLISH_SUFFIX)]

    def per_client(self, message: bytes, own: PerClient) -> bytes:
        """Add meta, escape and split as requested."""
        text = b"".join((self._own_prefix(own), message, messages.PUBLISH_SUFFIX))
        if own.is_ascii:
            text = ascii_only(text)
        return text_frames(text, own.fragment_size, f"publish:{self._topic}:{own.seq}")

    def shared_pieces(self, message: Pieces) -> Pieces:
        """Frame a large message."""
        return _framed(TEXT, self._prefix, message, messages.PUBLISH_SUFFIX)

    def per_client_pieces(self, message: Pieces, own: PerClient) -> bytes | Pieces:
        """Add meta, escape and split as requested. Only to split, all of it is copied."""
        if own.fragment_size is not None:
            return self.per_client(bytes(message), own)
        prefix = self._own_prefix(own)
        if own.is_ascii:
            prefix = ascii_only(prefix)
            message = Pieces.of(ascii_only(bytes(part)) for part in message.parts)
        return _framed(TEXT, prefix, message, messages.PUBLISH_SUFFIX)

    def _own_prefix(self, own: PerClient) -> bytes:
        if own.meta is None:
            return self._prefix
        return messages.publish_meta_prefix(self._topic, own.meta.members())


class PngFrames:
    """Makes `png` frames. A message is the base64 of a PNG that holds a whole `publish` message.

    Subscribers share the picture, so meta stands next to it, not within.
    """

    _PREFIX: Final = b'{"op":"png","data":"'
    _SUFFIX: Final = b'"}'

    def __init__(self, topic: str) -> None:
        self._topic = topic

    def shared(self, message: bytes) -> bytes:
        """Frame a message."""
        length = len(self._PREFIX) + len(message) + len(self._SUFFIX)
        return b"".join((header(TEXT, length), self._PREFIX, message, self._SUFFIX))

    def message(self, shared: bytes) -> bytes:
        """Take the message out of its frame."""
        return _after(self._PREFIX, shared)[: -len(self._SUFFIX)]

    def per_client(self, message: bytes, own: PerClient) -> bytes:
        """Add meta, and split as requested. Base64 is ASCII in any case."""
        end = b"}"
        if own.meta is not None:
            end = b"," + orjson.dumps(own.meta.members())[1:]
        text = b"".join((self._PREFIX, message, b'"', end))
        return text_frames(text, own.fragment_size, f"publish:{self._topic}:{own.seq}")

    def shared_pieces(self, message: Pieces) -> Pieces:
        """Frame a message in pieces."""
        return _framed(TEXT, self._PREFIX, message, self._SUFFIX)

    def per_client_pieces(self, message: Pieces, own: PerClient) -> bytes | Pieces:
        """Add meta, and split as requested."""
        return self.per_client(bytes(message), own)


class CborFrames:
    """Makes binary frames with a `publish` map. A message is CBOR."""

    _MSG: Final = cbor.text("msg")

    def __init__(self, topic: str) -> None:
        self._topic = topic
        self._prefix = self._up_to_message({})

    def shared(self, message: bytes) -> bytes:
        """Frame a message."""
        prefix = self._prefix
        return b"".join((header(BINARY, len(prefix) + len(message)), prefix, message))

    def message(self, shared: bytes) -> bytes:
        """Take the message out of its frame."""
        return _after(self._prefix, shared)

    def per_client(self, message: bytes, own: PerClient) -> bytes:
        """Add meta as requested. Rosbridge knows no fragments of binary frames."""
        prefix = self._own_prefix(own)
        return b"".join((header(BINARY, len(prefix) + len(message)), prefix, message))

    def shared_pieces(self, message: Pieces) -> Pieces:
        """Frame a large message."""
        return _framed(BINARY, self._prefix, message, b"")

    def per_client_pieces(self, message: Pieces, own: PerClient) -> Pieces:
        """Add meta as requested."""
        return _framed(BINARY, self._own_prefix(own), message, b"")

    def _own_prefix(self, own: PerClient) -> bytes:
        return self._prefix if own.meta is None else self._up_to_message(own.meta.members())

    def _up_to_message(self, meta: dict[str, object]) -> bytes:
        members = {"op": "publish", "topic": self._topic, **meta}
        # the map has one member more, and its items just follow each other
        items = [cbor.text(name) + cbor.dumps(value) for name, value in members.items()]
        return b"".join((cbor.head(cbor.MAP, len(members) + 1), *items, self._MSG))


def publish_frames(topic: str, compression: Compression) -> PublishFrames:
    """Return what makes the frames of a topic. *topic* is its name as requested."""
    match compression:
        case "none":
            return JsonFrames(topic)
        case "png":
            return PngFrames(topic)
        case "cbor" | "cbor-raw":
            return CborFrames(topic)


def _framed(kind: int, prefix: bytes, message: Pieces, suffix: bytes) -> Pieces:
    length = len(prefix) + len(message) + len(suffix)
    return message.within(header(kind, length) + prefix, suffix)


def _after(prefix: bytes, frame: bytes) -> bytes:
    return frame[_payload_offset(frame) + len(prefix) :]


def _payload_offset(frame: bytes) -> int:
    return {126: 4, 127: 10}.get(frame[1], 2)
