# SPDX-License-Identifier: Apache-2.0
"""The frames of a topic, which a front makes: one for all, or one for a client alone."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Protocol

from gateway.codec.chunks import Chunks
from gateway.core.requests import Compression


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

    def shared_chunks(self, message: Chunks) -> Chunks:
        """Return the shared frame of a large message, which is not copied."""

    def per_client_chunks(self, message: Chunks, own: PerClient) -> bytes | Chunks:
        """Return the frame, or frames in a row, of a large message for one subscriber."""


class Framing(Protocol):
    """Makes the frames of topics in one protocol."""

    def frames(self, topic: str, compression: Compression) -> PublishFrames:
        """Return what makes the frames of a topic. *topic* is its name as requested."""

    def text(self, topic: str, message: Iterable[bytes]) -> Iterator[bytes]:
        """Yield the whole text of a message in JSON, which becomes a picture, as ASCII."""
