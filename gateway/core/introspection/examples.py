# SPDX-License-Identifier: Apache-2.0
"""Frames that a person can paste as they are, made from a type."""

from collections.abc import Iterator
from typing import Any, Final

import orjson

from gateway.codec.types import ActionType, MessageType, ServiceType
from schemas.definition import FLOATS, STRINGS, Definition, Field
from schemas.installed import InstalledDefinitions

# Nobody has them: what is pasted from the description of a type must not reach a robot. The type is
# appended, as a topic has one type and a person pastes the examples of several.
EXAMPLE_TOPICS: Final = "/example/"
MAX_CHARACTERS: Final = 1000  # of the values: some lines of a terminal, which a person still reads
_MAX_DEPTH: Final = 6  # ROS messages nest 8 at most, arrays included
_MAX_ELEMENTS: Final = 9  # of an array of fixed length, such as a 3x3 matrix

_TIME: Final = "builtin_interfaces/msg/Time"


def publish_frame(
    message_type: MessageType, definitions: InstalledDefinitions, topic: str
) -> dict[str, Any]:
    """Return a `publish` that is accepted as it is, each field with its default value."""
    message = example(message_type.definition, definitions)
    return {"op": "publish", "topic": topic, "type": message_type.name, "msg": message}


def call_frame(
    service: str, service_type: ServiceType, definitions: InstalledDefinitions
) -> dict[str, Any]:
    """Return a call of a service."""
    args = example(service_type.request.definition, definitions)
    return {"op": "call_service", "service": service, "type": service_type.name, "args": args}


def goal_frame(
    action: str, action_type: ActionType, definitions: InstalledDefinitions
) -> dict[str, Any]:
    """Return a goal of an action."""
    args = example(action_type.goal.definition, definitions)
    return {
        "op": "send_action_goal",
        "id": 1,
        "action": action,
        "action_type": action_type.name,
        "args": args,
        "feedback": True,
    }


def example(definition: Definition, definitions: InstalledDefinitions) -> dict[str, Any]:
    """Return a value of a message type that shows its fields.

    Fields that make it too long are left out, as any message may do: long arrays of fixed length,
    and the nested messages of very large types.
    """
    for depth in range(_MAX_DEPTH, -1, -1):
        values = dict(_values(definition, definitions, depth))
        if len(orjson.dumps(values)) <= MAX_CHARACTERS:
            return values
    return {}


def _values(
    definition: Definition, definitions: InstalledDefinitions, depth: int
) -> Iterator[tuple[str, Any]]:
    for field in definition.fields:
        value = _value(field, definitions, depth)
        if value is not None:
            yield field.name, value


def _value(field: Field, definitions: InstalledDefinitions, depth: int) -> Any:
    """Return the value of a field, ``None`` to leave it out."""
    kind = field.type
    if kind.is_sequence and field.default is None:
        return "" if kind.is_octets else []
    if kind.is_array and (kind.length or 0) > _MAX_ELEMENTS:
        return None
    if field.default is not None:
        return list(field.default) if isinstance(field.default, tuple) else field.default
    value: Any
    if kind.is_primitive:
        value = _zero(kind.base)
    elif kind.base == _TIME:
        value = "now"
    else:
        nested = definitions.get(kind.base)
        value = dict(_values(nested, definitions, depth - 1)) if depth else {}
    return value if kind.length is None else [value] * kind.length


def _zero(base: str) -> bool | int | float | str:
    if base == "bool":
        return False
    if base in STRINGS:
        return ""
    return 0.0 if base in FLOATS else 0
