# SPDX-License-Identifier: Apache-2.0
"""The WebSocket frames around a message of a topic, for each `compression`."""

from dataclasses import dataclass
from typing import Final, Literal, Protocol

import orjson

from gateway.codec import cbor
from gateway.codec.json import ascii_only
from gateway.protocol import messages
from gateway.protocol.rosbridge_fragments import text_frames
from gateway.protocol.websocket_frames import BINARY, TEXT, header, payload_offset

Compression = Literal["none", "png", "cbor", "cbor-raw"]
"""How messages travel: as JSON, as JSON in a picture, as CBOR, or as CDR in CBOR."""


@dataclass(frozen=True, slots=True)
class Meta:
    """What a frame with meta: true tells beside the message."""

    seq: int
    received_ns: int
    dropped: int

    def members(self) -> dict[str, object]:
        """Return it by the names of the wire."""
        received = messages.time(self.received_ns)
        return {"seq": self.seq, "received": received, "dropped": self.dropped}


@dataclass(frozen=True, slots=True)
class Tailoring:
    """What sets one stream's frame apart from what the others get."""

    seq: int
    meta: Meta | None
    fragment_size: int | None
    is_ascii: bool


class Envelope(Protocol):
    """Makes frames of rendered messages."""

    def shared(self, body: bytes) -> bytes:
        """Return the frame as all streams get it that want nothing special."""

    def body(self, shared: bytes) -> bytes:
        """Return the message in such a frame."""

    def tailored(self, body: bytes, tailoring: Tailoring) -> bytes:
        """Return the frame, or frames in a row, as one stream gets it."""


class JsonEnvelope:
    """A `publish` frame; the body is the message as JSON."""

    def __init__(self, topic: str) -> None:
        self._topic = topic
        self._prefix = messages.publish_prefix(topic)

    def shared(self, body: bytes) -> bytes:
        """Frame it without looking at it."""
        prefix = self._prefix
        length = len(prefix) + len(body) + 1
        return b"".join((header(TEXT, length), prefix, body, messages.PUBLISH_SUFFIX))

    def body(self, shared: bytes) -> bytes:
        """Take it out of its frame."""
        return _behind(self._prefix, shared)[: -len(messages.PUBLISH_SUFFIX)]

    def tailored(self, body: bytes, tailoring: Tailoring) -> bytes:
        """Add meta, escape and cut as wished."""
        meta = tailoring.meta
        prefix = self._prefix
        if meta is not None:
            prefix = messages.publish_meta_prefix(
                self._topic, meta.seq, meta.received_ns, meta.dropped
            )
        text = b"".join((prefix, body, messages.PUBLISH_SUFFIX))
        if tailoring.is_ascii:
            text = ascii_only(text)
        return text_frames(text, tailoring.fragment_size, f"publish:{self._topic}:{tailoring.seq}")


class PngEnvelope:
    """A `png` frame; the body is the base64 of a PNG that hides a whole `publish` frame.

    Streams share the picture, so meta stands beside it, not within.
    """

    _PREFIX: Final = b'{"op":"png","data":"'
    _SUFFIX: Final = b'"}'

    def __init__(self, topic: str) -> None:
        self._topic = topic

    def shared(self, body: bytes) -> bytes:
        """Frame it."""
        length = len(self._PREFIX) + len(body) + len(self._SUFFIX)
        return b"".join((header(TEXT, length), self._PREFIX, body, self._SUFFIX))

    def body(self, shared: bytes) -> bytes:
        """Take it out of its frame."""
        return _behind(self._PREFIX, shared)[: -len(self._SUFFIX)]

    def tailored(self, body: bytes, tailoring: Tailoring) -> bytes:
        """Add meta, and cut as wished; it is ASCII in any case."""
        end = b"}"
        if tailoring.meta is not None:
            end = b"," + orjson.dumps(tailoring.meta.members())[1:]
        text = b"".join((self._PREFIX, body, b'"', end))
        return text_frames(text, tailoring.fragment_size, f"publish:{self._topic}:{tailoring.seq}")


class CborEnvelope:
    """A binary frame with a `publish` map; the body is the message as CBOR."""

    _MSG: Final = cbor.text("msg")

    def __init__(self, topic: str) -> None:
        self._topic = topic
        self._prefix = self._up_to_message({})

    def shared(self, body: bytes) -> bytes:
        """Frame it."""
        prefix = self._prefix
        return b"".join((header(BINARY, len(prefix) + len(body)), prefix, body))

    def body(self, shared: bytes) -> bytes:
        """Take it out of its frame."""
        return _behind(self._prefix, shared)

    def tailored(self, body: bytes, tailoring: Tailoring) -> bytes:
        """Add meta as wished; rosbridge knows no fragments of binary frames."""
        prefix = self._prefix
        if tailoring.meta is not None:
            prefix = self._up_to_message(tailoring.meta.members())
        return b"".join((header(BINARY, len(prefix) + len(body)), prefix, body))

    def _up_to_message(self, meta: dict[str, object]) -> bytes:
        members = {"op": "publish", "topic": self._topic, **meta}
        # the map has one member more, and its items just follow each other
        items = [cbor.text(name) + cbor.dumps(value) for name, value in members.items()]
        return b"".join((cbor.head(cbor.MAP, len(members) + 1), *items, self._MSG))


def envelope(topic: str, compression: Compression) -> Envelope:
    """Return what frames the messages of a topic, spelt as the client spelt it."""
    match compression:
        case "none":
            return JsonEnvelope(topic)
        case "png":
            return PngEnvelope(topic)
        case "cbor" | "cbor-raw":
            return CborEnvelope(topic)


def _behind(prefix: bytes, frame: bytes) -> bytes:
    return frame[payload_offset(frame) + len(prefix) :]
