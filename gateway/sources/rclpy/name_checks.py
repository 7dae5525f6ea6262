# SPDX-License-Identifier: Apache-2.0
"""Names of topics, services, actions and types, checked before ROS sees them.

rclpy expands relative names, ``~`` and ``{node}``, and truncates a name at a NUL byte: a permission
for the name as requested would then hold for another one.
"""

import re
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


def check_topic(topic: str) -> None:
    """Accept a fully qualified topic name and nothing else.

    Raises:
        RosError: ``bad_name``.
    """
    _check("topic", topic, MAX_TOPIC_CHARACTERS, example="/odom")


def check_service(service: str) -> None:
    """Accept a fully qualified service name and nothing else.

    Raises:
        RosError: ``bad_name``.
    """
    _check("service", service, MAX_TOPIC_CHARACTERS, example="/reset")


def check_action(action: str) -> None:
    """Accept a fully qualified action name and nothing else.

    Raises:
        RosError: ``bad_name``.
    """
    _check("action", action, MAX_ACTION_CHARACTERS, example="/dock")


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


def _check(noun: str, name: str, limit: int, *, example: str) -> None:
    if len(name) > limit:
        raise RosError("bad_name", f"{noun} name has {len(name)} characters, at most {limit}")
    if not _NAME.fullmatch(name):
        expected = f"fully qualified {noun} name such as {example}"
        raise RosError("bad_name", f"{name!r} is not a {expected}")
