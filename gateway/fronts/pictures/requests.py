# SPDX-License-Identifier: Apache-2.0
"""The parameters of `/snapshot` and `/stream`, as the subscription that they ask for.

They are those of web_video_server, whose addresses pages have, and some more.
"""

import contextlib
import html
import re
from collections.abc import Callable
from typing import Any, Final, NamedTuple
from urllib.parse import parse_qs, urlsplit

from gateway.codec.error_text import hint, truncate
from gateway.core.requests import MIN_RATE_HZ, ImageRequest, Subscribe
from gateway.fronts.pictures.framing import PictureFraming

SNAPSHOT: Final = "/snapshot"
STREAM: Final = "/stream"
VIEWER: Final = "/stream_viewer"  # a page with a stream
PATHS: Final = frozenset({SNAPSHOT, STREAM, VIEWER})

MAX_PARAMETERS: Final = 16  # there are seven, and six that are ignored


class PictureRequestError(ValueError):
    """Raised for a request with wrong parameters. The text is for the author of the address."""


class _Number(NamedTuple):
    member: str  # of the operation's `image`
    read: Callable[[str], float]
    least: float
    most: float


_NUMBER: Final = re.compile(r"[0-9.eE+-]{1,32}")
# a browser caches the image of an address, so pages change this parameter
_CHANGING: Final = "t"
# parameters of web_video_server for QoS, which adapts itself here, and for missing codecs
_IGNORED: Final = ("default_transport", "qos_profile", "bitrate", "gop", "qmin", "qmax")
# an <img> shows a JPEG for every type, a <video> does not
_TYPES: Final = ("mjpeg", "png", "ros_compressed")
_NUMBERS: Final = {
    "quality": _Number("quality", int, 1, 100),
    "width": _Number("max_width", int, 0, 8192),
    "height": _Number("max_height", int, 0, 8192),
    "fps": _Number("max_fps", float, MIN_RATE_HZ, 1000),
}
_OF_ALL: Final = ("topic", "type", "quality", "width", "height", _CHANGING)
_KNOWN: Final = {
    SNAPSHOT: _OF_ALL,
    STREAM: (*_OF_ALL, "fps"),
    VIEWER: (*_OF_ALL, "fps"),
}
_PAGE: Final = """\
<!doctype html>
<html lang="en">
<meta charset="utf-8">
<title>{topic}</title>
<img src="{source}" alt="pictures of {topic}">
</html>
"""


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
        raise PictureRequestError(f"too many parameters: send at most {MAX_PARAMETERS}") from error
    for name in query:
        if name == "invert":
            raise PictureRequestError(
                "invert: unknown. Turn the image with CSS instead: rotate: 180deg"
            )
        if name not in (*known, *_IGNORED):
            raise PictureRequestError(f"{truncate(name)}: unknown{hint(name, known)}")
        if len(query[name]) > 1 and name in known and name != _CHANGING:
            raise PictureRequestError(f"{name}: given {len(query[name])} times. Give it once")
    topic = query.get("topic", [""])[0]
    if not topic:
        raise PictureRequestError(
            f"topic is missing: name a topic of images, {address.path}?topic=/camera/image_raw"
        )
    if (kind := query.get("type", [_TYPES[0]])[0]) not in _TYPES:
        text = f"type: got {truncate(kind)!r}, but images are always JPEG: leave type out"
        raise PictureRequestError(text)
    image: dict[str, Any] = {
        number.member: _value(name, query[name][0], number)
        for name, number in _NUMBERS.items()
        if name in query
    }
    given = {name: value for name, value in image.items() if value}  # 0 means no limit
    adapts = "quality" not in given
    options = ImageRequest(format="jpeg", asks_for_picture=True, adapts=adapts, **given)
    return Subscribe(topic=topic, framing=PictureFraming(), queue_length=1, image=options)


def viewer_page(target: str, topic: str) -> bytes:
    """Return the page that shows the stream of a request target's parameters."""
    source = f"{STREAM.lstrip('/')}?{urlsplit(target).query}"  # relative: as behind a proxy
    return _PAGE.format(topic=html.escape(topic), source=html.escape(source)).encode()


def _value(name: str, text: str, number: _Number) -> float:
    value = float("nan")
    if _NUMBER.fullmatch(text):  # Python would also read 1_0, blanks, and digits of other scripts
        with contextlib.suppress(ValueError):
            value = number.read(text)
    if number.least <= value <= number.most:
        return value
    kind = "a whole number" if number.read is int else "a number"
    raise PictureRequestError(
        f"{name}: got {truncate(text)!r}, expected {kind} from {number.least:g} to {number.most:g}"
    )
