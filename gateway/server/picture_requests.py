# SPDX-License-Identifier: Apache-2.0
"""The parameters of `/snapshot` and `/stream`, as the subscription that they ask for."""

import contextlib
import re
from collections.abc import Callable
from typing import Final, Literal, NamedTuple
from urllib.parse import parse_qs, urlsplit

from gateway.codec.error_text import hint, truncate
from gateway.protocol.operations.base import MIN_RATE_HZ
from gateway.protocol.operations.topics import ImageRequest, Subscribe

Path = Literal["/snapshot", "/stream"]

SNAPSHOT: Final = "/snapshot"
STREAM: Final = "/stream"
PATHS: Final = frozenset({SNAPSHOT, STREAM})

MAX_PARAMETERS: Final = 16  # there are four, and each is parsed


class PictureRequestError(ValueError):
    """Raised when an address asks for no picture that there can be; the text is for its author."""


class _Number(NamedTuple):
    member: str  # of the operation's `image`
    read: Callable[[str], float]
    least: float
    most: float


_NUMBER: Final = re.compile(r"[0-9.eE+-]{1,32}")
# a browser takes an address that it has seen for one picture: a page changes this one
_IGNORED: Final = "t"
_NUMBERS: Final = {
    "quality": _Number("quality", int, 1, 100),
    "width": _Number("max_width", int, 1, 8192),
    "fps": _Number("max_fps", float, MIN_RATE_HZ, 1000),
}
_KNOWN: Final = {
    SNAPSHOT: ("topic", "quality", "width", _IGNORED),
    STREAM: ("topic", *_NUMBERS, _IGNORED),
}


def picture_request(target: str) -> Subscribe:
    """Return the subscription that a request target asks for.

    Raises:
        PictureRequestError: a parameter is missing, unknown or wrong.
    """
    address = urlsplit(target)
    known = _KNOWN[address.path]
    try:
        query = parse_qs(address.query, keep_blank_values=True, max_num_fields=MAX_PARAMETERS)
    except ValueError as error:
        raise PictureRequestError(f"at most {MAX_PARAMETERS} parameters") from error
    for name in query:
        if name not in known:
            raise PictureRequestError(f"{truncate(name)}: unknown{hint(name, known)}")
        if len(query[name]) > 1 and name != _IGNORED:
            raise PictureRequestError(f"{name}: given {len(query[name])} times; give it once")
    topic = query.get("topic", [""])[0]
    if not topic:
        raise PictureRequestError(
            f"topic: missing; name a topic of pictures: {address.path}?topic=/camera/image_raw"
        )
    image = {
        number.member: _value(name, query[name][0], number)
        for name, number in _NUMBERS.items()
        if name in query
    }
    options = ImageRequest.model_validate({"format": "jpeg", **image})
    return Subscribe(topic=topic, queue_length=1, image=options)


def _value(name: str, text: str, number: _Number) -> float:
    value = float("nan")
    if _NUMBER.fullmatch(text):  # Python reads 1_0, blanks and other scripts' digits, too
        with contextlib.suppress(ValueError):
            value = number.read(text)
    if number.least <= value <= number.most:
        return value
    kind = "a whole number" if number.read is int else "a number"
    raise PictureRequestError(
        f"{name}: got {truncate(text)!r}, expected {kind} from {number.least:g} to {number.most:g}"
    )
