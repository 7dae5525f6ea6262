# SPDX-License-Identifier: Apache-2.0
"""The frames that the server sends, as JSON bytes."""

from collections.abc import Mapping
from typing import Any, Final, Literal

import orjson

from gateway.protocol.errors import StatusCode

Level = Literal["none", "error", "warning", "info"]

SEVERITY: Final[Mapping[Level, int]] = {"none": 0, "error": 1, "warning": 2, "info": 3}


def status(
    level: Level,
    text: str,
    *,
    code: StatusCode | None = None,
    request: str | None = None,
    request_id: str | int | None = None,
) -> bytes:
    """Build a `status` frame; *request* is the operation it answers."""
    frame: dict[str, Any] = {"op": "status", "level": level, "msg": text}
    if request_id is not None:
        frame["id"] = request_id
    if code is not None:
        frame["code"] = code
    if request is not None:
        frame["request"] = request
    return orjson.dumps(frame)


def answer(op: str, request_id: str | int | None, **members: Any) -> bytes:
    """Build the answer to an operation of this gateway's own."""
    frame: dict[str, Any] = {"op": op}
    if request_id is not None:
        frame["id"] = request_id
    return orjson.dumps(frame | members)


def publish_prefix(topic: str) -> bytes:
    """Return the beginning of every `publish` frame of a topic, up to the message.

    The topic is spelt as the client spelt it: clients match frames by that text.
    """
    return b'{"op":"publish","topic":' + orjson.dumps(topic) + b',"msg":'


def publish_meta_prefix(topic: str, seq: int, received_ns: int, dropped: int) -> bytes:
    """Return the beginning of a `publish` frame with meta: true, up to the message."""
    return (
        b'{"op":"publish","topic":%b,"seq":%d,"received":{"sec":%d,"nanosec":%d},"dropped":%d,"msg":'
        % (orjson.dumps(topic), seq, *divmod(received_ns, 1_000_000_000), dropped)
    )


PUBLISH_SUFFIX: Final = b"}"


def time(nanoseconds: int) -> dict[str, int]:
    """Split nanoseconds as builtin_interfaces/msg/Time does."""
    sec, nanosec = divmod(nanoseconds, 1_000_000_000)
    return {"sec": sec, "nanosec": nanosec}
