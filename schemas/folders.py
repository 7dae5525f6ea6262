# SPDX-License-Identifier: Apache-2.0
"""Definitions in any folder, such as a workspace's ``src``, ``install`` or ``share``.

A file of definitions is ``PACKAGE/KIND/NAME.EXTENSION`` at any depth, also below KIND.
The package's name stands in the nearest ``package.xml`` above, else it is that of the folder.

A package with a ``package.xml`` may have files in other folders, such as ``ros2/``: colcon builds
what its CMakeLists.txt names.
"""

import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Final, NamedTuple

# Definitions that come with the gateway: of packages that robots have, and PyPI's wheels lack.
SHIPPED: Final = Path(__file__).parent / "definitions"
# The definitions of ROS itself, for a machine without ROS.
STANDARD: Final = Path(__file__).parent / "standard"
KINDS: Final = ("msg", "srv", "action")
MAX_FOLDERS: Final = 20_000  # half a second. A home directory has more

_PACKAGE: Final = re.compile(r"[a-z][a-z0-9_]*")
_TYPE: Final = re.compile(r"[A-Z][A-Za-z0-9]*")
_NAME_IN_XML: Final = re.compile(rb"<name>\s*([a-z][a-z0-9_]*)\s*</name>")
_ROS_1: Final = "ros1"  # next to ``ros2/`` in a package for both
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

    Files outside of a folder named by a KIND come last. Links are followed. Hidden folders, and
    those that colcon is told to ignore, are left out.

    Raises:
        OSError: the folder cannot be read, or is a file.
        TooManyFoldersError: it has too many below it.
    """
    os.scandir(folder).close()  # `os.walk` is also silent about the first one
    seen: set[tuple[int, int]] = set()  # links may lead round in a circle
    places: dict[Path, _Place] = {}
    elsewhere: list[Found] = []
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
        places[here] = _place(here, places.get(here.parent, _Place()))
        if places[here].package is not None and _ROS_1 in names:
            names.remove(_ROS_1)
        found = _in(here, places[here], sorted(files, key=_plain_first))
        if places[here].kind is None:
            elsewhere += found
        else:
            yield from found
    yield from elsewhere


class _Place(NamedTuple):
    """The package and the KIND of a folder, as far as the folders above it say."""

    package: str | None = None
    kind: str | None = None


def _place(here: Path, above: _Place) -> _Place:
    own = _named_in_xml(here)
    if own is not None:
        return _Place(own, here.name if here.name in KINDS else None)
    if here.name not in KINDS:
        return above
    package = above.package or _named_in_xml(here.parent) or here.parent.name
    return _Place(package, here.name)


def _plain_first(file: str) -> tuple[str, bool]:
    name, _, extension = file.rpartition(".")
    return name, extension == "idl"


def _in(here: Path, place: _Place, files: list[str]) -> Iterator[Found]:
    if not _PACKAGE.fullmatch(place.package or ""):
        return
    extensions = KINDS if place.kind is None else (place.kind, "idl")
    for file in files:
        name, _, extension = file.rpartition(".")
        path = here / file
        if extension in extensions and _TYPE.fullmatch(name) and path.is_file():
            yield Found(str(place.package), place.kind or extension, name, path)


def _named_in_xml(folder: Path) -> str | None:
    try:
        with (folder / "package.xml").open("rb") as file:
            found = _NAME_IN_XML.search(file.read(_MAX_XML_BYTES))
    except OSError:
        return None
    return found[1].decode() if found else None
