# SPDX-License-Identifier: Apache-2.0
"""Names of topics, services, actions and types, checked before ROS sees them.

rclpy expands relative names, ``~`` and ``{node}``, and truncates a name at a NUL byte: a permission
for the name as requested would then hold for another one.
"""

import re
from functools import partial
from typing import Final, Literal

from gateway.sources.source import RosError

TypeKind = Literal["msg", "srv", "action"]

# rmw's limit: the 255 characters of a DDS topic less its longest own prefix
MAX_TOPIC_CHARACTERS: Final = 247
# less the longest suffix that an action adds to its name
MAX_ACTION_CHARACTERS: Final = MAX_TOPIC_CHARACTERS - len("/_action/cancel_goal")

_NAME = re.compile(r"(?:/[A-Za-z_][A-Za-z0-9_]*)+", re.ASCII)
_TYPE = re.compile(r"([a-z][a-z0-9_]*)/(msg|srv|action)/([A-Z][A-Za-z0-9]*)", re.ASCII)
_NOUNS: Final = {"msg": "message", "srv": "service", "action": "action"}


def split_type(type_name: str, kind: TypeKind = "msg") -> tuple[str, str]:
    """Return the package and the short name of ``pkg/msg/Name``, or of another kind.

    Raises:
        RosError: ``bad_type``.
    """
    match = _TYPE.fullmatch(type_name)
    if match is None or match[2] != kind:
        expected = f"expected pkg/{kind}/Name"
        raise RosError(
            "bad_type", f"{type_name!r} is not a valid {_NOUNS[kind]} type name: {expected}"
        )
    return match[1], match[3]


def _check(noun: str, limit: int, example: str, name: str) -> None:
    """Accept a fully qualified name and nothing else.

    Raises:
        RosError: ``bad_name``.
    """
    if len(name) > limit:
        raise RosError("bad_name", f"{noun} name has {len(name)} characters, at most {limit}")
    if not _NAME.fullmatch(name):
        expected = f"fully qualified {noun} name such as {example}"
        raise RosError("bad_name", f"{name!r} is not a {expected}")


check_topic: Final = partial(_check, "topic", MAX_TOPIC_CHARACTERS, "/odom")
check_service: Final = partial(_check, "service", MAX_TOPIC_CHARACTERS, "/reset")
check_action: Final = partial(_check, "action", MAX_ACTION_CHARACTERS, "/dock")
