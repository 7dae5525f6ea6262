# SPDX-License-Identifier: Apache-2.0
"""The options that a client sets in the address of the WebSocket."""

from collections.abc import Sequence
from typing import NamedTuple, cast
from urllib.parse import parse_qs, urlsplit

from gateway.core.errors import SEVERITY, Level, StatusCode
from gateway.core.requests import IMAGE_FORMATS, ImageFormat


class UrlOptionError(ValueError):
    """Raised when an option of an address is not available. The text is for the client."""


class UrlOptions(NamedTuple):
    """The options of an address. ``None`` is for those that it leaves out."""

    images: ImageFormat | None
    status: Level | None  # as by `set_level`

    def told(self, code: StatusCode) -> StatusCode | None:
        """Return the code of a `status` to a client that is rejected, if it asks for one."""
        return None if self.status in {None, "none"} else code


def url_options(target: str) -> UrlOptions:
    """Return the options in a request's target.

    Raises:
        UrlOptionError: a value is not available.
    """
    query = urlsplit(target).query
    asked = parse_qs(query, keep_blank_values=True) if query else {}
    status = _one_of(tuple(SEVERITY), "status", asked)
    return UrlOptions(_one_of(IMAGE_FORMATS, "images", asked), cast("Level | None", status))


def _one_of(known: Sequence[str], name: str, asked: dict[str, list[str]]) -> str | None:
    """Return the last value of an option, or ``None`` without it."""
    if name not in asked:
        return None
    value = asked[name][-1]
    if value not in known:
        *others, last = known
        expected = f"{', '.join(others)} or {last}"
        raise UrlOptionError(f"{name}: got {value[:32]!r}, expected {expected}")
    return value
