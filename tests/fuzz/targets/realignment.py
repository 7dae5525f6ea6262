# SPDX-License-Identifier: Apache-2.0
"""Results that a server has sent: any type, any bytes behind a status."""

from functools import cache
from typing import Any

from gateway.codec.error_text import CodecError
from gateway.codec.json import dumps
from gateway.sources.realignment import Realignment
from gateway.sources.source import RosError
from tests.fuzz import types
from tests.fuzz.target import Target, check
from tests.fuzz.targets.cdr_decoder import HEADERS
from tests.fuzz.targets.cdr_decoder import corpus as of_decoder

STATUSES = (b"\4", b"\4\0\0", b"\4\0\0\0", b"\4" * 8)


@cache
def layout_of(name: str) -> Realignment:
    return Realignment(types.definitions().get(name), types.definitions())


def run(data: bytes) -> None:
    """Take the type from the first two bytes, byte order and status from the third."""
    message_type = types.chosen(data)
    number = data[2] if data[2:3] else 0
    header, before = HEADERS[number & 1], STATUSES[number >> 1 & 3]
    is_little_endian = header[1] == 1
    body = data[3:]
    layout = layout_of(message_type.name)
    known = decoded(message_type, header + body)
    try:
        behind = layout.move(body, 0, before, is_little_endian=is_little_endian)
        back = layout.move(behind, len(before), b"", is_little_endian=is_little_endian)
    except RosError as error:
        check(known is None, "refused, and decodes", str(error))
        return
    check(behind.startswith(before), "has lost the status")
    check(len(behind) < 8 * len(body) + 16, "grows", len(behind))
    if known is not None:
        check(decoded(message_type, header + back) == known, "comes back as another")


def decoded(message_type: Any, cdr: bytes) -> Any:
    try:
        return dumps(message_type.decode(cdr))
    except CodecError:
        return None


TARGET = Target("a result behind a status is moved, or refused", run, of_decoder)
