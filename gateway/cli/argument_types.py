# SPDX-License-Identifier: Apache-2.0
"""The kinds of the command line's arguments, and their types, which refuse a word in words."""

import argparse
from pathlib import Path
from typing import Any, Final, TypeAlias

from gateway.config.domain_id import DOMAIN_ID_EXPECTATION, is_domain_id
from schemas.assembly_name import EXPECTATION, is_assembly_name

MAX_TIMEOUT_S: Final = 600

# its only name: a parser, or a group of its arguments
Group: TypeAlias = "argparse._ActionsContainer"  # noqa: SLF001


def option(group: Group, name: str, metavar: str, text: str, **more: Any) -> None:
    """Add an argument with a value."""
    group.add_argument(name, metavar=metavar, help=text, **more)


def several(group: Group, flag: str, metavar: str, text: str, **more: Any) -> None:
    """Add a flag that may be given several times."""
    option(group, flag, metavar, f"{text} (repeatable)", action="append", default=[], **more)


def switch(group: Group, flag: str, text: str) -> None:
    """Add a flag without a value."""
    group.add_argument(flag, action="store_true", help=text)


def assembly_name(text: str) -> str:
    """Return the name of a Unity assembly."""
    if not is_assembly_name(text):
        raise argparse.ArgumentTypeError(f"got {text!r}, expected {EXPECTATION}")
    return text


def domain_id(text: str) -> int:
    """Return a DDS domain."""
    if not is_domain_id(text):
        raise argparse.ArgumentTypeError(f"got {text!r}, expected {DOMAIN_ID_EXPECTATION}")
    return int(text)


def folder(text: str) -> Path:
    """Return a path, which must be named: an empty one is the current folder."""
    if not text:
        raise argparse.ArgumentTypeError("no folder is named")
    return Path(text)


def seconds(text: str) -> float:
    """Return a time above 0, `MAX_TIMEOUT_S` at most."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0 < value <= MAX_TIMEOUT_S:
        raise argparse.ArgumentTypeError(
            f"got {text!r}, expected seconds above 0, at most {MAX_TIMEOUT_S}"
        )
    return value
