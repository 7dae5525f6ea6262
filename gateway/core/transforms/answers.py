# SPDX-License-Identifier: Apache-2.0
"""A transform that was found, or the reason why none is, as clients get it."""

from typing import Any

from gateway.codec.error_text import truncate
from gateway.core.errors import ProtocolError
from gateway.core.ros_time import stamp
from gateway.tf.buffer import FoundTransform
from gateway.tf.errors import ExtrapolationError, TransformError


def transform_stamped(target: str, source: str, found: FoundTransform) -> dict[str, Any]:
    """Return geometry_msgs/msg/TransformStamped: *source* in *target*, by these names."""
    x, y, z, qx, qy, qz, qw = found.transform
    return {
        "header": {"stamp": stamp(found.stamp_ns), "frame_id": target},
        "child_frame_id": source,
        "transform": {
            "translation": {"x": x, "y": y, "z": z},
            "rotation": {"x": qx, "y": qy, "z": qz, "w": qw},
        },
    }


def refusal(error: TransformError) -> ProtocolError:
    """Return the error that a client gets for a transform that is not known."""
    is_late = isinstance(error, ExtrapolationError)
    return ProtocolError("timeout" if is_late else "not_found", truncate(str(error)))
