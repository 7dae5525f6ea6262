# SPDX-License-Identifier: Apache-2.0
"""Find the interface definitions that a ROS 2 installation (or its wheels) put on this machine.

A service or an action is a file of several messages, which have the names that rosidl gives
them: ``std_srvs/srv/SetBool_Request``, ``test_msgs/action/Fibonacci_Feedback``.
"""

import json
import os
import re
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Final, Literal, get_args

from schemas.definition import Definition, DefinitionError, parse_definition
from schemas.interface import ROLES, Interface, InterfaceKind, Role, parse_interface, part_name

Kind = Literal["msg", "srv", "action"]

_TYPE_NAME: Final = re.compile(
    r"(?P<file>[a-z][a-z0-9_]*/(?P<kind>msg|srv|action)/[A-Z][A-Za-z0-9]*)(?:_[A-Z][a-z]+)?"
)
_EXPECTED: Final = {
    None: "service or action type name: expected pkg/srv/Name or pkg/action/Name",
    "srv": "service type name: expected pkg/srv/Name",
    "action": "action type name: expected pkg/action/Name",
}


class UnknownTypeError(LookupError):
    """No definition of a type is installed, or a name is none; the text says which."""


def installed_prefixes() -> tuple[Path, ...]:
    """Return the prefixes that may hold ``share/PKG/msg``: ROS overlays first, then wheels."""
    overlays = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    return tuple(dict.fromkeys(Path(prefix) for prefix in [*overlays, sys.prefix] if prefix))


def parts_of(interface: str) -> tuple[str, ...]:
    """Name the messages that ``pkg/srv/Name`` or ``pkg/action/Name`` consists of, in order.

    Raises:
        UnknownTypeError: *interface* is no such name.
    """
    return tuple(part_name(interface, role) for role in _roles_of(interface))


class InstalledDefinitions:
    """The definitions below some prefixes, read when first asked for and then kept.

    An earlier prefix hides a later one, like an overlay in ROS.
    """

    def __init__(self, prefixes: Sequence[Path] | None = None) -> None:
        self._prefixes = installed_prefixes() if prefixes is None else tuple(prefixes)
        self._known: dict[str, Definition] = {}
        self._interfaces: dict[str, Interface] = {}

    def get(self, name: str) -> Definition:
        """Return the definition of ``pkg/msg/Name``, or of a part of a service or an action.

        Raises:
            UnknownTypeError: it is not installed, or *name* is no such name.
            DefinitionError: its text cannot be parsed.
        """
        known = self._known.get(name)
        if known is None:
            known = self._known[name] = self._read(name)
        return known

    def interface(self, name: str, kind: InterfaceKind | None = None) -> Interface:
        """Return the definition of ``pkg/srv/Name`` or ``pkg/action/Name``, or only of one *kind*.

        Raises:
            UnknownTypeError, DefinitionError: as for `get`.
        """
        _roles_of(name, kind)
        known = self._interfaces.get(name)
        if known is None:
            known = self._interfaces[name] = parse_interface(name, *self._text_and_hashes(name))
        return known

    def names(self, packages: Iterable[str] | None = None, kind: Kind = "msg") -> list[str]:
        """List the installed messages, services or actions, of all packages or of some, sorted."""
        wanted = None if packages is None else set(packages)
        found = {
            f"{path.parts[-3]}/{kind}/{path.stem}"
            for prefix in self._prefixes
            for path in prefix.glob(f"share/*/{kind}/*.{kind}")
        }
        return sorted(name for name in found if wanted is None or name.split("/")[0] in wanted)

    def all_names(self) -> list[str]:
        """List all that is installed: messages, then services, then actions."""
        return [name for kind in get_args(Kind) for name in self.names(kind=kind)]

    def get_any(self, name: str) -> Definition | Interface:
        """Return the definition of a service or an action, else what `get` returns.

        Raises:
            UnknownTypeError, DefinitionError: as for `get`.
        """
        return self.interface(name) if _roles_in(name) else self.get(name)

    def closure(self, names: Iterable[str]) -> list[Definition]:
        """Return the definitions of *names* and of all they nest, nested ones first.

        Raises:
            UnknownTypeError, DefinitionError: as for `get`; also for a type that nests itself.
        """
        ordered: dict[str, Definition] = {}

        def visit(name: str, within: tuple[str, ...]) -> None:
            if name in within:
                raise DefinitionError(f"{name} nests itself")
            if name not in ordered:
                definition = self.get(name)
                for nested in definition.nested():
                    visit(nested, (*within, name))
                ordered[name] = definition

        for name in names:
            visit(name, ())
        return list(ordered.values())

    def _read(self, name: str) -> Definition:
        match = _TYPE_NAME.fullmatch(name)
        if match is not None and match["kind"] == "msg" and match["file"] == name:
            text, hashes = self._text_and_hashes(name)
            return parse_definition(name, text, hashes.get(name))
        if match is not None:
            for role in ROLES.get(match["kind"], ()):
                if part_name(match["file"], role) == name:
                    return self.interface(match["file"]).parts[role]
        raise UnknownTypeError(f"{name!r} is no message type name: expected pkg/msg/Name")

    def _text_and_hashes(self, name: str) -> tuple[str, dict[str, str]]:
        """Read the file of ``pkg/KIND/Name``, and the hashes that stand beside it."""
        package, kind, short_name = name.split("/")
        for prefix in self._prefixes:
            path = prefix / "share" / package / kind / f"{short_name}.{kind}"
            if path.is_file():
                # what is no UTF-8 stands in comments, where it harms nobody
                text = path.read_text(encoding="utf-8", errors="replace")
                return text, _type_hashes(path.with_suffix(".json"))
        raise UnknownTypeError(f"no definition of {name} is installed")


def _roles_of(interface: str, kind: InterfaceKind | None = None) -> tuple[Role, ...]:
    roles = _roles_in(interface)
    if not roles or (kind is not None and roles != ROLES[kind]):
        raise UnknownTypeError(f"{interface!r} is no {_EXPECTED[kind]}")
    return roles


def _roles_in(name: str) -> tuple[Role, ...]:
    match = _TYPE_NAME.fullmatch(name)
    if match is None or match["file"] != name:
        return ()
    return ROLES.get(match["kind"], ())


def _type_hashes(path: Path) -> dict[str, str]:
    """Read the REP-2011 hashes that stand beside a definition; ROS before Iron has none."""
    if not path.is_file():
        return {}
    entries = json.loads(path.read_bytes())["type_hashes"]
    return {str(entry["type_name"]): str(entry["hash_string"]) for entry in entries}
