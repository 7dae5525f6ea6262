# SPDX-License-Identifier: Apache-2.0
"""Messages as they come from the core: a picture is the bytes of a JPEG, without a frame."""

from typing import Final

from gateway.codec.chunks import Chunks
from gateway.codec.picture_message import PictureMessage
from gateway.core.frames import Framing, PerClient

JPEG_START: Final = b"\xff\xd8"


class _Unframed:
    def shared(self, message: bytes) -> bytes:
        return message

    message = shared

    def per_client(self, message: bytes, _: PerClient) -> bytes:
        return message

    def shared_chunks(self, message: Chunks) -> Chunks:
        return message

    def per_client_chunks(self, message: Chunks, _: PerClient) -> Chunks:
        return message


class PictureFraming(Framing):
    """Takes the JPEG alone. Any other message stays JSON."""

    def frames(self, topic: str) -> _Unframed:
        """Return what frames nothing."""
        del topic
        return _Unframed()

    def picture(self, picture: PictureMessage) -> bytes:
        """Return the JPEG."""
        return picture.data
