# SPDX-License-Identifier: Apache-2.0
"""The options that a client sets in the address of the WebSocket, for all that it does."""

from urllib.parse import parse_qs, urlsplit

from gateway.protocol.operations.topics import IMAGE_FORMATS, ImageFormat


class UrlOptionError(ValueError):
    """Raised when an address asks for something that is not there; the text is for the client."""


def image_format(target: str) -> ImageFormat | None:
    """Return the format of a request target's `images`; ``None`` without it.

    Raises:
        UrlOptionError: it is no format.
    """
    query = urlsplit(target).query
    asked = parse_qs(query, keep_blank_values=True).get("images") if query else None
    if asked is None:
        return None
    if asked[-1] not in IMAGE_FORMATS:
        *others, last = IMAGE_FORMATS
        expected = f"{', '.join(others)} or {last}"
        raise UrlOptionError(f"images: got {asked[-1][:32]!r}, expected {expected}")
    return asked[-1]
