# SPDX-License-Identifier: Apache-2.0
"""The definition of a service or an action: the messages in a `.srv` or an `.action` file."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Literal

from schemas.definition import Definition, DefinitionError, Field, FieldType
from schemas.definition_text import parse_definition

InterfaceKind = Literal["srv", "action"]
Role = Literal["request", "response", "goal", "result", "feedback"]

# The messages in a file of each kind, in order.
ROLES: Final[Mapping[str, tuple[Role, ...]]] = MappingProxyType(
    {"srv": ("request", "response"), "action": ("goal", "result", "feedback")}
)
SEPARATOR: Final = "---"

SEND_GOAL: Final = "_SendGoal"
GET_RESULT: Final = "_GetResult"
FEEDBACK_MESSAGE: Final = "_FeedbackMessage"
EVENT: Final = "_Event"

_GOAL_ID: Final = Field("goal_id", FieldType("unique_identifier_msgs/msg/UUID"))
_STAMP: Final = Field("stamp", FieldType("builtin_interfaces/msg/Time"))
_EVENT_INFO: Final = Field("info", FieldType("service_msgs/msg/ServiceEventInfo"))


@dataclass(frozen=True, slots=True)
class Interface:
    """A service or an action: its full name (``pkg/srv/Name``), its messages and source text."""

    name: str
    parts: Mapping[Role, Definition]  # in the order of the file
    text: str = ""
    type_hash: str | None = None  # REP-2011, of all that ROS derives. None if none is installed

    @property
    def package(self) -> str:
        """The package of the type."""
        return self.name.split("/")[0]


def part_name(interface: str, role: Role) -> str:
    """Return rosidl's name of a message of a service or an action: ``pkg/srv/Name_Request``."""
    return f"{interface}_{role.capitalize()}"


def parse_interface(name: str, text: str, hashes: Mapping[str, str] | None = None) -> Interface:
    """Parse the text of a `.srv` or an `.action` file. *hashes* are those installed, by type name.

    Raises:
        DefinitionError: the file has too few or too many parts, or one cannot be parsed.
    """
    known = hashes or {}
    lines = text.splitlines()
    # As in rosidl, a separator has no blank next to it.
    ends = [number for number, line in enumerate(lines) if line == SEPARATOR]
    roles = ROLES[name.split("/")[1]]
    if len(ends) != len(roles) - 1:
        raise DefinitionError(
            f"{name}: expected {len(roles)} parts ({', '.join(roles)}) with a line --- between "
            f"them, got {len(ends) + 1}"
        )
    parts: dict[Role, Definition] = {}
    starts = [0, *(end + 1 for end in ends)]
    for role, start, end in zip(roles, starts, [*ends, len(lines)], strict=True):
        part = part_name(name, role)
        section = "".join(f"{line}\n" for line in lines[start:end])
        parts[role] = parse_definition(part, section, known.get(part), first_line=start + 1)
    return Interface(name, MappingProxyType(parts), text, known.get(name))


def derive(interface: Interface) -> dict[str, Definition]:
    """Return what rosidl makes of a service or an action, by name: its parts, and what it derives.

    A service is a structure of three messages, of which the event is for introspection. An action
    has two services and a message that carry its parts together with the goal's id. Names and
    fields are those of https://design.ros2.org/articles/actions.html and of
    `rosidl_parser.definition`.
    """
    derived = _of_action if "goal" in interface.parts else _of_service
    own = (*interface.parts.values(), *derived(interface.name))
    return {definition.name: definition for definition in own}


def _of_service(name: str) -> Iterator[Definition]:
    request, response, event = (f"{name}{part}" for part in ("_Request", "_Response", EVENT))
    called, answered = (FieldType(part, is_sequence=True, bound=1) for part in (request, response))
    yield Definition(event, (_EVENT_INFO, Field("request", called), Field("response", answered)))
    yield _structure(name, request_message=request, response_message=response, event_message=event)


def _of_action(name: str) -> Iterator[Definition]:
    goal, result, feedback = (part_name(name, role) for role in ("goal", "result", "feedback"))
    send_goal, get_result, message = name + SEND_GOAL, name + GET_RESULT, name + FEEDBACK_MESSAGE
    yield Definition(f"{send_goal}_Request", (_GOAL_ID, Field("goal", FieldType(goal))))
    yield Definition(f"{send_goal}_Response", (Field("accepted", FieldType("bool")), _STAMP))
    yield from _of_service(send_goal)
    yield Definition(f"{get_result}_Request", (_GOAL_ID,))
    status = Field("status", FieldType("int8"))
    yield Definition(f"{get_result}_Response", (status, Field("result", FieldType(result))))
    yield from _of_service(get_result)
    yield Definition(message, (_GOAL_ID, Field("feedback", FieldType(feedback))))
    yield _structure(
        name,
        goal=goal,
        result=result,
        feedback=feedback,
        send_goal_service=send_goal,
        get_result_service=get_result,
        feedback_message=message,
    )


def _structure(name: str, **parts: str) -> Definition:
    return Definition(name, tuple(Field(each, FieldType(part)) for each, part in parts.items()))
