# SPDX-License-Identifier: Apache-2.0
"""The interface definitions that a ROS 2 installation (or its wheels) put on this machine.

A service or an action is a file of several messages, which have rosidl's names, as the messages
that rosidl derives: ``std_srvs/srv/SetBool_Request``,
``test_msgs/action/Fibonacci_FeedbackMessage``.
"""

import copy
import json
import os
import re
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Final, Literal, get_args

from schemas.definition import Definition, DefinitionError
from schemas.definition_text import parse_definition
from schemas.folders import find_definitions
from schemas.guess import MAX_GUESSED, guess, guess_text
from schemas.idl import parse_idl_interface, parse_idl_message
from schemas.interface import ROLES, Interface, InterfaceKind, Role, derive, parse_interface
from schemas.type_size import TypeSize, size_of

Kind = Literal["msg", "srv", "action"]

_TYPE_NAME: Final = re.compile(
    r"(?P<file>[a-z][a-z0-9_]*/(?P<kind>msg|srv|action)/[A-Z][A-Za-z0-9]*)(?:_[A-Z][A-Za-z]+)*"
)
# of what rosidl makes of a service or an action, the messages
_PARTS: Final = {
    "srv": re.compile("_(?:Request|Response|Event)"),
    "action": re.compile(
        "_(?:Goal|Result|Feedback(?:Message)?|(?:SendGoal|GetResult)_(?:Request|Response|Event))"
    ),
}
_EXPECTED: Final = {
    None: "service or action type name: expected pkg/srv/Name or pkg/action/Name",
    "srv": "service type name: expected pkg/srv/Name",
    "action": "action type name: expected pkg/action/Name",
}
_IDL: Final = "idl"
# Of types within types: Python's parser and stack have their ends. ROS' own have 6 at most.
MAX_NESTING: Final = 64
MAX_TOLD: Final = 1024  # definitions, as many as types that are made
MAX_DEFINITION_BYTES: Final = 256 * 1024  # the largest in use have 10 kB


class UnknownTypeError(LookupError):
    """No definition of *name* is installed, or it is not a type name. The text says which.

    *name* may be a type that the requested one nests. It *is_missing* if a file would mend that.
    """

    def __init__(self, name: str, reason: str, *, is_missing: bool = False) -> None:
        super().__init__(reason)
        self.name = name
        self.is_missing = is_missing


def is_message_name(name: str) -> bool:
    """Return whether *name* is of the form ``pkg/msg/Name``."""
    match = _TYPE_NAME.fullmatch(name)
    return match is not None and match["kind"] == "msg" and match["file"] == name


def installed_prefixes() -> tuple[Path, ...]:
    """Return the prefixes that may hold ``share/PKG/msg``: ROS overlays first, then wheels."""
    overlays = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    return tuple(dict.fromkeys(Path(prefix) for prefix in [*overlays, sys.prefix] if prefix))


@dataclass(frozen=True, slots=True)
class _Found:
    """The text of a file, its notation, and the hashes of the types in it."""

    text: str
    is_idl: bool
    hashes: Mapping[str, str]


class InstalledDefinitions:
    """The definitions below some prefixes, read on first use and then kept.

    An earlier prefix hides a later one, like an overlay in ROS. A package may have its definitions
    as `.idl` files alone. Types that no prefix has may be in one of *folders*, which are searched
    at once. See `schemas.folders.find_definitions` for the search and its exceptions.
    """

    def __init__(
        self, prefixes: Sequence[Path] | None = None, folders: Iterable[Path] = ()
    ) -> None:
        self._prefixes = installed_prefixes() if prefixes is None else tuple(prefixes)
        self._in_folders: dict[tuple[str, str, str], Path] = {}
        for found in chain.from_iterable(map(find_definitions, folders)):
            self._in_folders.setdefault(found[:3], found.path)
        self.revision = 0
        self._installed: set[str] = set()  # as far as that was asked for
        self._told: dict[str, Definition] = {}
        self._untold: dict[str, str] = {}  # why a definition was not told, by type
        self._known: dict[str, Definition] = {}
        self._interfaces: dict[str, Interface] = {}
        self._listed: dict[Kind, Mapping[str, Sequence[str]]] = {}

    def get(self, name: str) -> Definition:
        """Return the definition of ``pkg/msg/Name``, or of a part of a service or an action.

        Raises:
            UnknownTypeError: it is not installed, or *name* is not a name of this form.
            DefinitionError: its text cannot be parsed.
        """
        known = self._known.get(name)
        if known is None:
            known = self._known[name] = self._read(name)
        return known

    def is_installed(self, name: str) -> bool:
        """Return whether an installed package has the definition of ``pkg/msg/Name``."""
        if name not in self._installed and is_message_name(name) and self._installed_place(name):
            self._installed.add(name)
        return name in self._installed

    def with_told(self, told: Mapping[str, Definition]) -> "InstalledDefinitions":
        """Return a copy that also has these definitions."""
        other = copy.copy(self)
        other._told = {**self._told, **told}  # noqa: SLF001  # its own
        other._known = {name: each for name, each in self._known.items() if name not in told}  # noqa: SLF001
        return other

    def tell(self, told: Mapping[str, Definition]) -> None:
        """Use these definitions from now on."""
        self._told.update(told)
        for name in told:
            self._known.pop(name, None)
            self._untold.pop(name, None)
        self._listed.clear()
        self.revision += 1

    def note_untold(self, name: str, why: str) -> None:
        """Have the error about a type that is unknown say why no node has told it."""
        if len(self._untold) >= MAX_TOLD:
            self._untold.pop(next(iter(self._untold)))
        self._untold[name] = why

    @property
    def told(self) -> Mapping[str, Definition]:
        """The definitions that nodes have told."""
        return self._told

    def interface(self, name: str, kind: InterfaceKind | None = None) -> Interface:
        """Return the definition of ``pkg/srv/Name`` or ``pkg/action/Name``. *kind* admits only one.

        Raises:
            UnknownTypeError, DefinitionError: as for `get`.
        """
        _roles_of(name, kind)
        known = self._interfaces.get(name)
        if known is None:
            found = self._find(name)
            parse = parse_idl_interface if found.is_idl else parse_interface
            known = self._interfaces[name] = parse(name, found.text, found.hashes)
        return known

    def names(self, packages: Iterable[str] | None = None, kind: Kind = "msg") -> list[str]:
        """List the installed messages, services or actions, of all packages or of some, sorted."""
        wanted = None if packages is None else set(packages)
        found = (
            f"{package}/{kind}/{short_name}"
            for package, short_names in self._list(kind).items()
            if wanted is None or package in wanted
            for short_name in short_names
        )
        return sorted(found)

    def packages_in_folders(self) -> set[str]:
        """Return the packages that *folders* have types of, installed or not."""
        return {package for package, _, _ in self._in_folders}

    def all_names(self) -> list[str]:
        """List all installed types: messages, then services, then actions."""
        return [name for kind in get_args(Kind) for name in self.names(kind=kind)]

    def get_any(self, name: str) -> Definition | Interface:
        """Return the definition of a service or an action, else that of `get`.

        Raises:
            UnknownTypeError, DefinitionError: as for `get`.
        """
        return self.interface(name) if _roles_in(name) else self.get(name)

    def closure(self, names: Iterable[str]) -> list[Definition]:
        """Return the definitions of *names* and of all nested types, nested ones first.

        Raises:
            UnknownTypeError, DefinitionError: as for `get`. Also for a type that nests itself, or
                nests others deeper than `MAX_NESTING`, or is larger than `size_of` allows.
        """
        ordered: dict[str, Definition] = {}
        sizes: dict[str, TypeSize] = {}

        def visit(name: str, within: tuple[str, ...]) -> None:
            if name in within:
                raise DefinitionError(f"{name} nests itself")
            if len(within) > MAX_NESTING:
                raise DefinitionError(f"{within[0]} nests types deeper than {MAX_NESTING} levels")
            if name not in ordered:
                definition = self.get(name)
                for nested in definition.nested():
                    visit(nested, (*within, name))
                sizes[name] = size_of(definition, sizes)
                ordered[name] = definition

        for name in names:
            visit(name, ())
        return list(ordered.values())

    def nearest(self, name: str) -> str | None:
        """Guess the type that an unknown name means: misspelt, abbreviated, or of another package.

        It compares with the types of one package, not with all installed ones.
        """
        match = _TYPE_NAME.fullmatch(name[:MAX_GUESSED])
        if match is None:
            return self.meant(name)
        package, _, short_name = match["file"].split("/")
        kind: Kind = match["kind"]  # type: ignore[assignment]  # the pattern knows these three
        return _joined(guess(package, short_name, self._list(kind)), kind)

    def meant(self, text: str, kind: Kind = "msg") -> str | None:
        """Guess the type of a kind that a text means which is not of the form of a type name."""
        return _joined(guess_text(text, self._list(kind)), kind)

    def _list(self, kind: Kind) -> Mapping[str, Sequence[str]]:
        """Return the known types by package. Reading the directories takes milliseconds.

        Packages of which nothing is installed are the last.
        """
        listed = self._listed.get(kind)
        if listed is None:
            found: dict[str, set[str]] = {}
            for prefix in self._prefixes:
                for path in prefix.glob(f"share/*/{kind}/*.*"):
                    if path.suffix[1:] in {kind, _IDL}:
                        found.setdefault(path.parts[-3], set()).add(path.stem)
            installed = frozenset(found)
            told = (tuple(name.split("/")) for name in self._told)
            for package, its_kind, short_name in (*self._in_folders, *told):
                if its_kind == kind:
                    found.setdefault(package, set()).add(short_name)
            order = sorted(found, key=lambda package: (package not in installed, package))
            listed = {package: sorted(found[package]) for package in order}
            self._listed[kind] = listed
        return listed

    def _read(self, name: str) -> Definition:
        if name in self._told:
            return self._told[name]
        if is_message_name(name):
            found = self._find(name)
            parse = parse_idl_message if found.is_idl else parse_definition
            return parse(name, found.text, found.hashes.get(name))
        match = _TYPE_NAME.fullmatch(name)
        parts = None if match is None else _PARTS.get(match["kind"])
        if match is not None and parts is not None and parts.fullmatch(name, match.end("file")):
            return derive(self.interface(match["file"]))[name]
        raise UnknownTypeError(
            name, f"{name!r} is not a valid message type name: expected pkg/msg/Name"
        )

    def _find(self, name: str) -> "_Found":
        """Read the file of ``pkg/KIND/Name``, and the hashes next to it."""
        try:
            path, is_installed = self._place(name)
            if path.stat().st_size > MAX_DEFINITION_BYTES:
                reason = f"the definition of {name} has over {MAX_DEFINITION_BYTES} bytes"
                raise UnknownTypeError(name, reason)
            # invalid UTF-8 is in comments, where it is harmless
            text = path.read_text(encoding="utf-8", errors="replace")
            # the hash of a file that a user may edit is computed
            hashes = _type_hashes(path.with_suffix(".json")) if is_installed else {}
            return _Found(text, path.suffix[1:] == _IDL, hashes)
        except OSError as error:  # a name longer than any file's, a file that is not ours
            reason = f"no definition of {name} can be read: {error.strerror}"
            raise UnknownTypeError(name, reason) from error

    def _place(self, name: str) -> tuple[Path, bool]:
        """Return the file of ``pkg/KIND/Name``, and whether it is installed."""
        installed = self._installed_place(name)
        if installed is not None:
            return installed, True
        package, kind, short_name = name.split("/")
        known = self._in_folders.get((package, kind, short_name))
        if known is None:
            why = self._untold.get(name)
            reason = f"no definition of {name} is installed{f', and {why}' if why else ''}"
            raise UnknownTypeError(name, reason, is_missing=True)
        return known, False

    def _installed_place(self, name: str) -> Path | None:
        package, kind, short_name = name.split("/")
        for prefix in self._prefixes:
            # rosidl writes IDL next to each .msg file, which has the comments as they were written
            for suffix in (kind, _IDL):
                path = prefix / "share" / package / kind / f"{short_name}.{suffix}"
                if path.is_file():
                    return path
        return None


def _roles_of(interface: str, kind: InterfaceKind | None = None) -> tuple[Role, ...]:
    roles = _roles_in(interface)
    if not roles or (kind is not None and roles != ROLES[kind]):
        raise UnknownTypeError(interface, f"{interface!r} is not a valid {_EXPECTED[kind]}")
    return roles


def _roles_in(name: str) -> tuple[Role, ...]:
    match = _TYPE_NAME.fullmatch(name)
    if match is None or match["file"] != name:
        return ()
    return ROLES.get(match["kind"], ())


def _joined(found: tuple[str, str] | None, kind: Kind) -> str | None:
    return None if found is None else f"{found[0]}/{kind}/{found[1]}"


def _type_hashes(path: Path) -> dict[str, str]:
    """Read the REP-2011 hashes next to a definition.

    ROS before Iron has no such file, and a file of that name may be something else: then return no
    hashes.
    """
    try:
        entries = json.loads(path.read_bytes())["type_hashes"]
        return {str(entry["type_name"]): str(entry["hash_string"]) for entry in entries}
    except (OSError, ValueError, KeyError, TypeError):
        return {}
