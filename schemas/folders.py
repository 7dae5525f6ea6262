# SPDX-License-Identifier: Apache-2.0
"""Definitions in any folder, such as a workspace's ``src``, ``install`` or ``share``.

A file of definitions is ``PACKAGE/KIND/NAME.EXTENSION`` at any depth. The package's name stands in
``package.xml``, as the folder may be called otherwise; without one it is the folder's.
"""

import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Final, NamedTuple

# Definitions that come with the gateway: of packages that robots have, and PyPI's wheels lack.
SHIPPED: Final = Path(__file__).parent / "definitions"
KINDS: Final = ("msg", "srv", "action")
MAX_FOLDERS: Final = 20_000  # half a second; a home directory has more

_PACKAGE: Final = re.compile(r"[a-z][a-z0-9_]*")
_TYPE: Final = re.compile(r"[A-Z][A-Za-z0-9]*")
_NAME_IN_XML: Final = re.compile(rb"<name>\s*([a-z][a-z0-9_]*)\s*</name>")
_MAX_XML_BYTES: Final = 64 * 1024
_IGNORED: Final = frozenset({"COLCON_IGNORE", "AMENT_IGNORE"})  # colcon's marks in its own folders


class TooManyFoldersError(OSError):
    """A folder has over `MAX_FOLDERS` below it: surely it is not one of packages."""


class Found(NamedTuple):
    """One file of definitions."""

    package: str
    kind: str
    name: str
    path: Path


def find_definitions(folder: Path) -> Iterator[Found]:
    """Yield the files below a folder in the order of their paths, `.msg` before `.idl`.

    Links are followed. Hidden folders, and those that colcon is told to ignore, are left out.

    Raises:
        OSError: the folder cannot be read, or is a file.
        TooManyFoldersError: it has too many below it.
    """
    os.scandir(folder).close()  # `os.walk` is silent about the first one, too
    seen: set[tuple[int, int]] = set()  # links may lead round in a circle
    for place, names, files in os.walk(folder, followlinks=True):
        here = Path(place)
        try:
            status = here.stat()
        except OSError:  # it was there when its parent was read
            names.clear()
            continue
        is_ignored = bool(seen) and not _IGNORED.isdisjoint(files)
        if is_ignored or (status.st_dev, status.st_ino) in seen:
            names.clear()
            continue
        seen.add((status.st_dev, status.st_ino))
        if len(seen) > MAX_FOLDERS:
            raise TooManyFoldersError(0, f"over {MAX_FOLDERS} folders below it", str(folder))
        names[:] = sorted(name for name in names if not name.startswith("."))
        if here.name in KINDS:
            yield from _in(here, sorted(files, key=_plain_first))


def _plain_first(file: str) -> tuple[str, bool]:
    name, _, extension = file.rpartition(".")
    return name, extension == "idl"


def _in(place: Path, files: list[str]) -> Iterator[Found]:
    kind = place.name
    package = _package(place.parent)
    if package is None:
        return
    for file in files:
        name, _, extension = file.rpartition(".")
        path = place / file
        if extension in {kind, "idl"} and _TYPE.fullmatch(name) and path.is_file():
            yield Found(package, kind, name, path)


def _package(folder: Path) -> str | None:
    try:
        with (folder / "package.xml").open("rb") as file:
            found = _NAME_IN_XML.search(file.read(_MAX_XML_BYTES))
    except OSError:
        found = None
    name = found[1].decode() if found else folder.name
    return name if _PACKAGE.fullmatch(name) else None
