# SPDX-License-Identifier: Apache-2.0
"""The velocity in a client's Twist or TwistStamped."""

import json
import math
import struct
from collections.abc import Mapping
from typing import Final, NamedTuple

from gateway.codec.error_text import CodecError
from gateway.codec.types import MessageType
from gateway.core.errors import ProtocolError
from gateway.drive.twist_cdr import TWIST
from gateway.drive.velocity import Velocity

_PARTS: Final = tuple(f"{part}.{axis}" for part in ("linear", "angular") for axis in "xyz")
_SIX_DOUBLES: Final = struct.Struct("<6d")


class TwistValues(NamedTuple):
    """The values of a command. The gateway stamps it itself when it accepts it."""

    velocity: Velocity
    frame_id: str = ""


def read(message_type: MessageType, msg: object) -> TwistValues:
    """Check a message, and return its values. Those that a relay has read are returned as they are.

    Raises:
        ProtocolError: ``invalid_value``: it does not fit its type, or a number is not finite.
            ``null`` and names such as ``"NaN"``, which stand for NaN elsewhere, are refused.
    """
    if isinstance(msg, TwistValues):
        return msg
    try:
        cdr = message_type.encode(msg, 0)
    except CodecError as error:
        raise ProtocolError("invalid_value", str(error)) from error
    # the last fields of both types, which the encoder writes little-endian
    velocity = Velocity(*_SIX_DOUBLES.unpack(cdr[-_SIX_DOUBLES.size :]))
    if not velocity.is_finite:
        number = next(n for n, value in enumerate(velocity) if not math.isfinite(value))
        root = "msg" if message_type.name == TWIST else "msg.twist"
        path = f"{root}.{_PARTS[number]}"
        got = "null" if _is_null(msg, path) else json.dumps(velocity[number])
        raise ProtocolError("invalid_value", f"{path}: expected a finite number, got {got}")
    return TwistValues(velocity, _frame_id(msg))


def _is_null(msg: object, path: str) -> bool:
    """Return whether a value of a message that fits its type is null. Otherwise it is NaN."""
    _, *names = path.split(".")
    for name in names:
        msg = msg.get(name) if isinstance(msg, Mapping) else None
    return msg is None


def _frame_id(msg: object) -> str:
    header = msg.get("header") if isinstance(msg, Mapping) else None
    frame_id = header.get("frame_id") if isinstance(header, Mapping) else None
    return frame_id if isinstance(frame_id, str) else ""
