# SPDX-License-Identifier: Apache-2.0
"""The velocity in a client's Twist or TwistStamped."""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from gateway.codec.errors import CodecError
from gateway.codec.types import MessageType
from gateway.drive.twist_cdr import TWIST
from gateway.drive.velocity import Velocity
from gateway.protocol.errors import ProtocolError

_PARTS = tuple((part, axis) for part in ("linear", "angular") for axis in "xyz")


class TwistValues(NamedTuple):
    """The values of a command; the gateway stamps it itself, when it accepts it."""

    velocity: Velocity
    frame_id: str = ""


def read(message_type: MessageType, msg: object) -> TwistValues:
    """Check a message, and return its values.

    Raises:
        ProtocolError: ``invalid_value``: it does not fit its type, or a number is not finite;
            ``null``, which is NaN elsewhere, is refused as well.
    """
    try:
        message_type.validate(msg, 0)
    except CodecError as error:
        raise ProtocolError("invalid_value", str(error)) from error
    if not isinstance(msg, Mapping):  # the type's own check has refused it
        raise ProtocolError("invalid_value", "msg: expected an object")
    if message_type.name == TWIST:
        return TwistValues(_velocity(msg, "msg"))
    header = msg.get("header")
    frame_id = header.get("frame_id") if isinstance(header, Mapping) else None
    twist = msg.get("twist")
    velocity = _velocity(twist if isinstance(twist, Mapping) else {}, "msg.twist")
    return TwistValues(velocity, frame_id if isinstance(frame_id, str) else "")


def _velocity(twist: Mapping[str, Any], root: str) -> Velocity:
    return Velocity(*(_number(twist, part, axis, root) for part, axis in _PARTS))


def _number(twist: Mapping[str, Any], part: str, axis: str, root: str) -> float:
    vector = twist.get(part)
    value = vector.get(axis, 0.0) if isinstance(vector, Mapping) else 0.0
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    number = float(value) if is_number else math.nan
    if not math.isfinite(number):
        shown = "null" if value is None else "another"
        raise ProtocolError(
            "invalid_value", f"{root}.{part}.{axis}: expected a finite number, got {shown}"
        )
    return number
