# SPDX-License-Identifier: Apache-2.0
"""The files of the configuration: those of this machine, and the one that a person names.

The files of this machine are ``config.toml`` and ``config.d/*.toml`` in ``/etc/ros2-gateway``.
"""

import reprlib
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, NamedTuple

from gateway.errors import system_reason
from schemas.backports import tomllib

FILE_VARIABLE: Final = "ROS2_GATEWAY_CONFIG"
FOLDER_VARIABLE: Final = "ROS2_GATEWAY_CONFIG_DIR"
FOLDER: Final = Path("/etc/ros2-gateway")


class Given(NamedTuple):
    """One unchecked value from one source. ``is_text`` if the source has only strings."""

    key: str  # dotted, as in limits.max_clients
    value: object
    source: str  # its name for the operator: --port, ROS2_GATEWAY_PORT, gateway.toml:3
    is_text: bool = True


@dataclass
class Files:
    """The files that were read, later ones override earlier ones, and what is wrong with them."""

    read: list[Path] = field(default_factory=list)
    given: list[Given] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)
    ignored: list[Path] = field(default_factory=list)


def read_files(
    environment: Mapping[str, str],
    file: Path | None,
    known: Collection[str],
    *,
    only_named: bool = False,
) -> Files:
    """Read the files of this machine, and then the named one. *known* has the keys of settings.

    The file that is named by a flag replaces the one that the environment names. With *only_named*,
    those of this machine count only if the environment names their directory.
    """
    if file is None and environment.get(FILE_VARIABLE):
        file = Path(environment[FILE_VARIABLE])
    files = Files()
    folder = environment.get(FOLDER_VARIABLE)
    of_machine = [] if only_named and not folder else _of_this_machine(folder, files)
    for path in (*of_machine, *([] if file is None else [file])):
        _read(path, known, files)
    return files


def lines_of_keys(text: str) -> Mapping[str, int]:
    """Return the line on which each key of a valid TOML document begins, also of each table."""
    found: dict[str, int] = {}
    table, statement, begin = "", "", 1
    for number, line in enumerate(text.splitlines(keepends=True), 1):
        statement += line
        try:
            document = tomllib.loads(table + statement)
        except tomllib.TOMLDecodeError:  # a value goes on in the next line
            continue
        for key in _keys(document):
            found.setdefault(key, begin)
        if statement.lstrip().startswith("["):
            table = statement
        statement, begin = "", number + 1
    return found


def _of_this_machine(named: str | None, files: Files) -> Iterator[Path]:
    folder = Path(named) if named else FOLDER
    main = folder / "config.toml"
    if main in _listed(folder, files, must_exist=bool(named)):
        yield main
    for path in _listed(folder / "config.d", files):
        if path.suffix == ".toml" and not path.name.startswith("."):
            yield path
        else:
            files.ignored.append(path)


def _listed(folder: Path, files: Files, *, must_exist: bool = False) -> Sequence[Path]:
    try:
        return sorted(folder.iterdir())
    except OSError as error:
        if must_exist or not isinstance(error, FileNotFoundError):
            files.problems.append(f"cannot read {folder}, {system_reason(error)}")
        return ()


def _read(path: Path, known: Collection[str], files: Files) -> None:
    try:
        text = path.read_bytes().decode()
        document = tomllib.loads(text)
    except OSError as error:
        files.problems.append(f"cannot read {path}, {system_reason(error)}")
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        files.problems.append(f"{path} is not valid TOML: {error}")
    else:
        files.read.append(path)
        _flatten(document, _Place(path, lines_of_keys(text), known), files)


class _Place(NamedTuple):
    path: Path
    lines: Mapping[str, int]
    known: Collection[str]

    def of(self, key: str) -> str:
        line = self.lines.get(key)
        return str(self.path) if line is None else f"{self.path}:{line}"


def _flatten(table: Mapping[str, object], place: _Place, files: Files, prefix: str = "") -> None:
    for name, value in table.items():
        key = prefix + name
        if not any(other.startswith(f"{key}.") for other in place.known):
            files.given.append(Given(key, value, place.of(key), is_text=False))
        elif isinstance(value, dict):
            _flatten(value, place, files, f"{key}.")
        else:
            problem = f"{place.of(key)}: {key}: got {reprlib.repr(value)}, expected a table"
            files.problems.append(problem)


def _keys(table: Mapping[str, object], prefix: str = "") -> Iterator[str]:
    for name, value in table.items():
        yield prefix + name
        if isinstance(value, dict):
            yield from _keys(value, f"{prefix}{name}.")
