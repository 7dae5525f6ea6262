# SPDX-License-Identifier: Apache-2.0
"""Names of topics and types, checked before ROS sees them.

rclpy expands relative names, ``~`` and ``{node}``, and cuts a name at a NUL byte: a permission
given for the name that was asked for would then hold for another one.
"""

import re
from typing import Final

from gateway.ports import RosError

# rmw's limit: the 255 characters of a DDS topic less its longest own prefix
MAX_TOPIC_CHARACTERS: Final = 247

_TOPIC = re.compile(r"(?:/[A-Za-z_][A-Za-z0-9_]*)+", re.ASCII)
_TYPE = re.compile(r"([a-z][a-z0-9_]*)/msg/([A-Z][A-Za-z0-9]*)", re.ASCII)


def check_topic(topic: str) -> None:
    """Accept a fully qualified topic name and nothing else.

    Raises:
        RosError: ``bad_name``.
    """
    if len(topic) > MAX_TOPIC_CHARACTERS:
        raise RosError(
            "bad_name", f"topic name has {len(topic)} characters, at most {MAX_TOPIC_CHARACTERS}"
        )
    if not _TOPIC.fullmatch(topic):
        raise RosError("bad_name", f"{topic!r} is no fully qualified topic name such as /odom")


def split_type(type_name: str) -> tuple[str, str]:
    """Return the package and the short name of ``pkg/msg/Name``.

    Raises:
        RosError: ``bad_type``.
    """
    match = _TYPE.fullmatch(type_name)
    if match is None:
        raise RosError("bad_type", f"{type_name!r} is no message type name: expected pkg/msg/Name")
    return match[1], match[2]
