# SPDX-License-Identifier: Apache-2.0
"""The kinds of the command line's arguments, and their types, which refuse a word in words."""

import argparse
import math
import re
from pathlib import Path
from typing import Any, Final, TypeAlias

from gateway.config.domain_id import DOMAIN_ID_EXPECTATION, is_domain_id
from gateway.sources.recording.options import MAX_RATE, MIN_RATE
from schemas.assembly_name import EXPECTATION, is_assembly_name

MAX_TIMEOUT_S: Final = 600
_TIMEOUT: Final = "for connecting, and for each answer (default 10)"

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


def add_access(group: Group, timeout: str = _TIMEOUT) -> None:
    """Add what a command needs to connect to a running gateway, in addition to its address."""
    token = "file with its token alone (default: the token in $ROS2_GATEWAY_TOKEN)"  # noqa: S105
    option(group, "--token-file", "FILE", token, type=Path)
    option(group, "--ca", "FILE", "certificate in PEM to trust, such as its cert.pem", type=Path)
    option(group, "--timeout", "SECONDS", timeout, type=seconds)


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


def zenoh_address(text: str) -> str:
    """Return the address of a Zenoh router."""
    if not re.fullmatch(r"[a-z0-9_-]+/[^/\s;=]+(?:[?#][^\s;]*)?", text):
        raise argparse.ArgumentTypeError(
            f"got {text!r}, expected PROTOCOL/HOST:PORT such as tcp/robot:7447"
        )
    return text


def folder(text: str) -> Path:
    """Return a path, which must be named: an empty one is the current folder."""
    if not text:
        raise argparse.ArgumentTypeError("no folder is named")
    return Path(text)


def seconds(text: str) -> float:
    """Return a time above 0, `MAX_TIMEOUT_S` at most."""
    value = _number(text)
    if not 0 < value <= MAX_TIMEOUT_S:
        raise argparse.ArgumentTypeError(
            f"got {text!r}, expected seconds above 0, at most {MAX_TIMEOUT_S}"
        )
    return value


def play_rate(text: str) -> float:
    """Return how many times as fast as it was a recording is played."""
    value = _number(text)
    if not MIN_RATE <= value <= MAX_RATE:
        raise argparse.ArgumentTypeError(
            f"got {text!r}, expected a factor from {MIN_RATE:g} to {MAX_RATE:g}"
        )
    return value


def seconds_from_start(text: str) -> float:
    """Return a place in a recording."""
    value = _number(text)
    if not 0 <= value < math.inf:
        raise argparse.ArgumentTypeError(f"got {text!r}, expected seconds from 0")
    return value


def _number(text: str) -> float:
    """Return a number, NaN for other text, which no range contains."""
    try:
        return float(text)
    except ValueError:
        return math.nan
