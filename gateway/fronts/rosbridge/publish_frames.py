# SPDX-License-Identifier: Apache-2.0
"""The frames of topics.

A message of a topic is framed once and its bytes are shared by all subscribers, which a WebSocket
library cannot do for us: it frames per connection.
"""

from typing import TYPE_CHECKING, Final, cast

import orjson

from gateway.codec import cbor
from gateway.codec.chunks import Chunks
from gateway.codec.json import ascii_only
from gateway.core.frames import Meta, PerClient
from gateway.core.ros_time import stamp
from gateway.fronts.rosbridge import messages
from gateway.fronts.rosbridge.fragments import split
from gateway.transport.websocket_frames import BINARY, TEXT, header, payload_offset, text_frame

if TYPE_CHECKING:  # it imports this
    from gateway.fronts.rosbridge.framing import RosbridgeFraming


def text_frames(text: bytes, fragment_size: int | None, fragment_id: str) -> bytes:
    """Return the frames for a JSON text: one, or several in a row. See `split`."""
    if fragment_size is None:
        return text_frame(text)
    return b"".join(map(text_frame, split(text, fragment_size, fragment_id)))


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
        return text_frames(text, _fragment_size(own), f"publish:{self._topic}:{own.seq}")

    def shared_chunks(self, message: Chunks) -> Chunks:
        """Frame a large message."""
        return _framed(TEXT, self._prefix, message, messages.PUBLISH_SUFFIX)

    def per_client_chunks(self, message: Chunks, own: PerClient) -> bytes | Chunks:
        """Add meta, escape and split as requested. Only to split, all of it is copied."""
        if _fragment_size(own) is not None:
            return self.per_client(bytes(message), own)
        prefix = self._own_prefix(own)
        if own.is_ascii:
            prefix = ascii_only(prefix)
            message = Chunks.of(ascii_only(bytes(part)) for part in message.parts)
        return _framed(TEXT, prefix, message, messages.PUBLISH_SUFFIX)

    def _own_prefix(self, own: PerClient) -> bytes:
        if own.meta is None:
            return self._prefix
        return messages.publish_meta_prefix(self._topic, _members(own.meta))


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
            end = b"," + orjson.dumps(_members(own.meta))[1:]
        text = b"".join((self._PREFIX, message, b'"', end))
        return text_frames(text, _fragment_size(own), f"publish:{self._topic}:{own.seq}")

    def shared_chunks(self, message: Chunks) -> Chunks:
        """Frame a message in pieces."""
        return _framed(TEXT, self._PREFIX, message, self._SUFFIX)

    def per_client_chunks(self, message: Chunks, own: PerClient) -> bytes | Chunks:
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

    def shared_chunks(self, message: Chunks) -> Chunks:
        """Frame a large message."""
        return _framed(BINARY, self._prefix, message, b"")

    def per_client_chunks(self, message: Chunks, own: PerClient) -> Chunks:
        """Add meta as requested."""
        return _framed(BINARY, self._own_prefix(own), message, b"")

    def _own_prefix(self, own: PerClient) -> bytes:
        return self._prefix if own.meta is None else self._up_to_message(_members(own.meta))

    def _up_to_message(self, meta: dict[str, object]) -> bytes:
        members = {"op": "publish", "topic": self._topic, **meta}
        # the map has one member more, and its items just follow each other
        items = [cbor.text(name) + cbor.dumps(value) for name, value in members.items()]
        return b"".join((cbor.head(cbor.MAP, len(members) + 1), *items, self._MSG))


def _fragment_size(own: PerClient) -> int | None:
    return cast("RosbridgeFraming", own.framing).fragment_size


def _members(meta: Meta) -> dict[str, object]:
    """Return what ``meta: true`` adds to a `publish` frame."""
    members: dict[str, object] = {
        "seq": meta.seq,
        "received": stamp(meta.received_ns),
        "size": meta.size,
        "dropped": meta.dropped,
    }
    return members if meta.quality is None else members | {"quality": meta.quality}


def _framed(kind: int, prefix: bytes, message: Chunks, suffix: bytes) -> Chunks:
    length = len(prefix) + len(message) + len(suffix)
    return message.within(header(kind, length) + prefix, suffix)


def _after(prefix: bytes, frame: bytes) -> bytes:
    return frame[payload_offset(frame) + len(prefix) :]
