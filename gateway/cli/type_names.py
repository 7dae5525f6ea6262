# SPDX-License-Identifier: Apache-2.0
"""The types that commands take as arguments, and the words about those that are unknown."""

import argparse
import re
from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from typing import Final

from gateway.config.settings import load
from gateway.definitions import known_definitions
from gateway.errors import UsageError
from schemas.installed import InstalledDefinitions
from schemas.table import Table, TypeNameError, resolve_any

_PATTERN: Final = re.compile(
    r"(?:(?P<package>[a-z][a-z0-9_]*)/)?(?:(?P<kind>msg|srv|action)/)?\*", re.ASCII
)


def local_definitions(
    arguments: argparse.Namespace, environment: Mapping[str, str]
) -> InstalledDefinitions:
    """Return those of installed packages and of the folders that options or a file name.

    Raises:
        ConfigError: a folder, or the configuration that names it, is wrong.
    """
    configured = load(environment=environment, file=arguments.config).config.types.paths
    sources = {"--types-path": arguments.types_path, "types.paths": configured}
    named = " or ".join(source for source, paths in sources.items() if paths)
    return known_definitions([*arguments.types_path, *configured], named)


class TypeNames:
    """Finds the full names of types, in some definitions or in the list of message types."""

    def __init__(self, definitions: InstalledDefinitions) -> None:
        self._definitions = definitions
        self._table = Table.load()
        rows = (row.name for row in self._table.interfaces)
        self._known = {*self._table.by_name, *rows, *definitions.all_names()}

    def resolve(self, requested: str) -> str:
        """Return the full name for a name or a number, which may be unknown.

        Raises:
            UsageError: it is not a type name. The text has the nearest one, if there is one.
        """
        try:
            return resolve_any(requested, self._table, self._known)
        except TypeNameError as error:
            raise UsageError(f"{error}{self._meant(error)}") from error

    def nearest(self, name: str) -> str | None:
        """Guess the type that an unknown full name means, and return ``None`` for a known one.

        A known name lacks something else, and no other name helps.
        """
        if name in self._known:
            return None
        close = get_close_matches(name, self._known, n=1)
        return close[0] if close else self._definitions.nearest(name)

    def _meant(self, error: TypeNameError) -> str:
        near = error.requested and self._definitions.meant(error.requested, error.kind)
        if near:
            return f", did you mean {near}"
        if error.requested.startswith("/"):  # a topic, a service or an action
            frame = f'{{"op":"describe","type":"{error.requested}"}}'
            return f". A running gateway knows the types of names: send it {frame}"
        return ""


def is_pattern(requested: str) -> bool:
    """Return whether a text stands for several types: ``*``, ``pkg/*`` or ``pkg/srv/*``."""
    return _PATTERN.fullmatch(requested) is not None


def matching(pattern: str, names: Iterable[str]) -> list[str]:
    """Return those of *names* that a pattern stands for.

    Raises:
        UsageError: nothing fits. The text has the nearest package, if there is one.
    """
    match = _PATTERN.fullmatch(pattern)
    package, kind = (match["package"], match["kind"]) if match else ("", "")
    packages = set()
    found = []
    for name in names:
        its_package, its_kind, _ = name.split("/")
        packages.add(its_package)
        if package in {None, its_package} and kind in {None, its_kind}:
            found.append(name)
    if not found:
        near = get_close_matches(package or "", sorted(packages - {package}), n=1)
        hint = f", did you mean {near[0]}/*" if near else ""
        raise UsageError(f"no known type fits {pattern}{hint}")
    return found
