# SPDX-License-Identifier: Apache-2.0
"""Messages as they come from the core: a picture is the bytes of a JPEG, without a frame."""

from typing import Final

from gateway.codec.picture_message import PictureMessage
from gateway.core.frames import Framing, Unframed

JPEG_START: Final = b"\xff\xd8"


class PictureFraming(Framing):
    """Takes the JPEG alone. Any other message stays JSON."""

    def frames(self, topic: str) -> Unframed:
        """Return what frames nothing."""
        del topic
        return Unframed()

    def picture(self, picture: PictureMessage) -> bytes:
        """Return the JPEG."""
        return picture.data
