# SPDX-License-Identifier: Apache-2.0
"""The types of the command line's arguments: each takes a word, or refuses it in words."""

import argparse
from pathlib import Path
from typing import Final

from gateway.config.domain_id import DOMAIN_ID_EXPECTATION, is_domain_id
from schemas.assembly_name import EXPECTATION, is_assembly_name

MAX_TIMEOUT_S: Final = 600


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
