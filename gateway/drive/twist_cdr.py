# SPDX-License-Identifier: Apache-2.0
"""CDR of a Twist and of a TwistStamped, for the gateway and for its guard process."""

import struct
from typing import Final

from gateway.drive.velocity import Velocity

TWIST: Final = "geometry_msgs/msg/Twist"
TWIST_STAMPED: Final = "geometry_msgs/msg/TwistStamped"
COMMAND_TYPES: Final = (TWIST, TWIST_STAMPED)

_LITTLE_ENDIAN: Final = b"\0\1\0\0"  # the encapsulation header of CDR (DDSI-RTPS 2.5, 10.2)


def encode(type_name: str, velocity: Velocity, stamp_ns: int = 0, frame_id: str = "") -> bytes:
    """Return a message of one of the `COMMAND_TYPES`. A Twist has no stamp."""
    numbers = struct.pack("<6d", *velocity)
    if type_name == TWIST:
        return _LITTLE_ENDIAN + numbers
    text = frame_id.encode() + b"\0"
    header = struct.pack("<iII", *divmod(stamp_ns, 1_000_000_000), len(text)) + text
    # a double is aligned to 8, counted from behind the encapsulation header
    return _LITTLE_ENDIAN + header + b"\0" * (-len(header) % 8) + numbers
