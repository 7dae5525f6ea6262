# SPDX-License-Identifier: Apache-2.0
"""The definition of a service or an action: the messages in a `.srv` or an `.action` file."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Literal

from schemas.definition import Definition, DefinitionError, parse_definition

InterfaceKind = Literal["srv", "action"]
Role = Literal["request", "response", "goal", "result", "feedback"]

# The messages in a file of each kind, in order. No client sends or gets the types that ROS derives
# from them (the event of a service, the goal service and the feedback topic of an action).
ROLES: Final[Mapping[str, tuple[Role, ...]]] = MappingProxyType(
    {"srv": ("request", "response"), "action": ("goal", "result", "feedback")}
)
SEPARATOR: Final = "---"


@dataclass(frozen=True, slots=True)
class Interface:
    """A service or an action: its full name (``pkg/srv/Name``), its messages and source text."""

    name: str
    parts: Mapping[Role, Definition]  # in the order of the file
    text: str = ""
    type_hash: str | None = None  # REP-2011, of all that ROS derives; None if none is installed

    @property
    def package(self) -> str:
        """The package of the type."""
        return self.name.split("/")[0]


def part_name(interface: str, role: Role) -> str:
    """Return rosidl's name of a message of a service or an action: ``pkg/srv/Name_Request``."""
    return f"{interface}_{role.capitalize()}"


def parse_interface(name: str, text: str, hashes: Mapping[str, str] | None = None) -> Interface:
    """Parse the text of a `.srv` or an `.action` file; *hashes* are those installed, by type name.

    Raises:
        DefinitionError: the file has too few or too many parts, or one cannot be parsed.
    """
    known = hashes or {}
    lines = text.splitlines()
    # As in rosidl, a separator has no blank beside it.
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
