# SPDX-License-Identifier: Apache-2.0
"""Find the message definitions that a ROS 2 installation (or its wheels) put on this machine."""

import json
import os
import re
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

from schemas.definition import Definition, DefinitionError, parse_definition

_TYPE_NAME = re.compile(r"(?P<package>[a-z][a-z0-9_]*)/msg/(?P<name>[A-Z][A-Za-z0-9]*)")


class UnknownTypeError(LookupError):
    """No definition of a message type is installed; the text says where it was looked for."""


def installed_prefixes() -> tuple[Path, ...]:
    """Return the prefixes that may hold ``share/PKG/msg``: ROS overlays first, then wheels."""
    overlays = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    return tuple(dict.fromkeys(Path(prefix) for prefix in [*overlays, sys.prefix] if prefix))


class InstalledDefinitions:
    """The definitions below some prefixes, read when first asked for and then kept.

    An earlier prefix hides a later one, like an overlay in ROS.
    """

    def __init__(self, prefixes: Sequence[Path] | None = None) -> None:
        self._prefixes = installed_prefixes() if prefixes is None else tuple(prefixes)
        self._known: dict[str, Definition] = {}

    def get(self, name: str) -> Definition:
        """Return the definition of ``pkg/msg/Name``.

        Raises:
            UnknownTypeError: it is not installed, or *name* is no such name.
            DefinitionError: its text cannot be parsed.
        """
        known = self._known.get(name)
        if known is None:
            known = self._known[name] = self._read(name)
        return known

    def names(self, packages: Iterable[str] | None = None) -> list[str]:
        """List the installed message types, of all packages or of some, sorted."""
        wanted = None if packages is None else set(packages)
        found = {
            f"{path.parts[-3]}/msg/{path.stem}"
            for prefix in self._prefixes
            for path in prefix.glob("share/*/msg/*.msg")
        }
        return sorted(name for name in found if wanted is None or name.split("/")[0] in wanted)

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
        if match is None:
            raise UnknownTypeError(f"{name!r} is no message type name: expected pkg/msg/Name")
        for prefix in self._prefixes:
            path = prefix / "share" / match["package"] / "msg" / f"{match['name']}.msg"
            if path.is_file():
                # what is no UTF-8 stands in comments, where it harms nobody
                text = path.read_text(encoding="utf-8", errors="replace")
                return parse_definition(name, text, _type_hash(path.with_suffix(".json"), name))
        raise UnknownTypeError(f"no definition of {name} is installed")


def _type_hash(path: Path, name: str) -> str | None:
    """Read the REP-2011 hash that stands beside a definition; ROS before Iron has none."""
    if not path.is_file():
        return None
    for entry in json.loads(path.read_bytes())["type_hashes"]:
        if entry["type_name"] == name:
            return str(entry["hash_string"])
    return None
