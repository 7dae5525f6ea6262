# SPDX-License-Identifier: Apache-2.0
"""The types that rosidl derives from a service or an action, for their hashes and descriptions.

A service is a structure of three messages, of which the event is for introspection. An action has
two services and a message that carry its parts together with the goal's id; their names and fields
are those of https://design.ros2.org/articles/actions.html and of `rosidl_parser.definition`.
"""

from collections.abc import Iterable
from dataclasses import replace
from typing import Final

from schemas.definition import Definition, Field, FieldType
from schemas.installed import InstalledDefinitions, UnknownTypeError
from schemas.interface import Interface, part_name
from schemas.type_hash import type_hash

SEND_GOAL: Final = "_SendGoal"
GET_RESULT: Final = "_GetResult"
FEEDBACK_MESSAGE: Final = "_FeedbackMessage"

_GOAL_ID: Final = Field("goal_id", FieldType("unique_identifier_msgs/msg/UUID"))
_STAMP: Final = Field("stamp", FieldType("builtin_interfaces/msg/Time"))
_EVENT_INFO: Final = Field("info", FieldType("service_msgs/msg/ServiceEventInfo"))


def hashed(interface: Interface, definitions: InstalledDefinitions) -> Interface:
    """Return a service or an action with its hash, which is computed if none is installed.

    Without one, if a type that the hash covers is not known: ROS before Iron has no service_msgs.

    Raises:
        DefinitionError: a type that it nests cannot be read.
    """
    if interface.type_hash is not None:
        return interface
    derived = DerivedDefinitions(interface, definitions)
    try:
        return replace(interface, type_hash=type_hash(derived.get(interface.name), derived))
    except UnknownTypeError:
        return interface


class DerivedDefinitions:
    """The definitions of one service or action, of its parts, and of what is derived from them."""

    def __init__(self, interface: Interface, definitions: InstalledDefinitions) -> None:
        self._definitions = definitions
        self._known = {part.name: part for part in interface.parts.values()}
        if "goal" in interface.parts:
            self._derive_action(interface.name)
        else:
            self._derive_service(interface.name)

    def get(self, name: str) -> Definition:
        """Return a definition by rosidl's name of it, such as ``pkg/action/Name_SendGoal_Request``.

        Raises:
            UnknownTypeError, DefinitionError: as for `InstalledDefinitions.get`.
        """
        return self._known.get(name) or self._definitions.get(name)

    def names(self) -> list[str]:
        """List the parts and all that is derived."""
        return list(self._known)

    def closure(self, names: Iterable[str]) -> list[Definition]:
        """Return the definitions of *names* and of all nested types, in no order.

        Raises:
            UnknownTypeError, DefinitionError: as for `InstalledDefinitions.closure`.
        """
        own: dict[str, Definition] = {}
        others: dict[str, None] = {}
        left = list(names)
        while left:
            name = left.pop()
            if name not in self._known:
                others[name] = None
            elif name not in own:
                own[name] = self._known[name]
                left += own[name].nested()
        return [*self._definitions.closure(others), *own.values()]

    def _derive_service(self, name: str) -> None:
        request, response, event = (f"{name}_{part}" for part in ("Request", "Response", "Event"))
        called, answered = (
            FieldType(part, is_sequence=True, bound=1) for part in (request, response)
        )
        self._add(event, _EVENT_INFO, Field("request", called), Field("response", answered))
        self._add_parts(
            name, request_message=request, response_message=response, event_message=event
        )

    def _derive_action(self, name: str) -> None:
        goal, result, feedback = (part_name(name, role) for role in ("goal", "result", "feedback"))
        send_goal, get_result = name + SEND_GOAL, name + GET_RESULT
        self._add(f"{send_goal}_Request", _GOAL_ID, Field("goal", FieldType(goal)))
        self._add(f"{send_goal}_Response", Field("accepted", FieldType("bool")), _STAMP)
        self._derive_service(send_goal)
        self._add(f"{get_result}_Request", _GOAL_ID)
        status = Field("status", FieldType("int8"))
        self._add(f"{get_result}_Response", status, Field("result", FieldType(result)))
        self._derive_service(get_result)
        message = name + FEEDBACK_MESSAGE
        self._add(message, _GOAL_ID, Field("feedback", FieldType(feedback)))
        self._add_parts(
            name,
            goal=goal,
            result=result,
            feedback=feedback,
            send_goal_service=send_goal,
            get_result_service=get_result,
            feedback_message=message,
        )

    def _add_parts(self, name: str, **parts: str) -> None:
        self._add(name, *(Field(each, FieldType(part)) for each, part in parts.items()))

    def _add(self, name: str, *fields: Field) -> None:
        self._known[name] = Definition(name, fields)
