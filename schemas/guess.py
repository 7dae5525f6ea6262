# SPDX-License-Identifier: Apache-2.0
"""The type that a wrong name probably means."""

import difflib
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Final

Listed = Mapping[str, Sequence[str]]
"""The short names of the known types of one kind, by package. An earlier package is preferred."""

# Of names that differ by a typing error. difflib's own 0.6 takes two to three times as long.
_LIKENESS: Final = 0.75
_MIN_ABBREVIATION: Final = 3  # characters. "Po" may mean anything
# Characters of a name that are compared: the time is proportional, and clients may send any name.
MAX_GUESSED: Final = 128
# ROS', C++'s and Python's: geometry_msgs::msg::Twist, geometry_msgs.msg.Twist
_SEPARATORS: Final = re.compile(r"[/.:]+")
_KINDS: Final = frozenset({"msg", "srv", "action"})
# They repeat the names of others, for demonstrations and tests.
_DOUBLES: Final = frozenset({"example_interfaces", "test_msgs"})


def guess(package: str, short_name: str, listed: Listed) -> tuple[str, str] | None:
    """Return the package and the short name that were probably meant.

    A short name may be misspelt, abbreviated, or in another case. A package misspelt or another.
    The short name is compared with those of one package, not with all that are installed.
    """
    for near in _close(package, listed):
        found = _short_name(short_name, listed[near])
        if found is not None:
            return near, found
    return _owner(short_name, listed)


def guess_text(text: str, listed: Listed) -> tuple[str, str] | None:
    """Return what was probably meant by a text that is not of the form of a type name.

    Such as ``Twits``, ``std_msgs/string`` or ``std_msgs::msg::String``. A short name alone is
    compared with all others, which takes 4 ms if there are 1,500.
    """
    parts = [part for part in _SEPARATORS.split(text[:MAX_GUESSED]) if part]
    match [part for part in parts if part not in _KINDS]:
        case [short_name]:
            return _owner(short_name, listed) or _misspelt(short_name, listed)
        case [package, short_name]:
            return guess(package, short_name, listed)
    return None


def _short_name(meant: str, names: Sequence[str]) -> str | None:
    plain = _plain(meant)
    close = [name for name in names if _plain(name) == plain] or _close(meant, names)
    if not close and len(plain) >= _MIN_ABBREVIATION:
        close = sorted((name for name in names if _plain(name).startswith(plain)), key=len)
    return close[0] if close else None


def _owner(short_name: str, listed: Listed) -> tuple[str, str] | None:
    """Find a package that has a type of this name."""
    plain = _plain(short_name)
    for package in sorted(listed, key=lambda each: each in _DOUBLES):
        for name in listed[package]:
            if _plain(name) == plain:
                return package, name
    return None


def _misspelt(short_name: str, listed: Listed) -> tuple[str, str] | None:
    close = _close(short_name, sorted({name for names in listed.values() for name in names}))
    return _owner(close[0], listed) if close else None


def _plain(name: str) -> str:
    return name.replace("_", "").lower()


def _close(name: str, names: Iterable[str]) -> list[str]:
    return difflib.get_close_matches(name, names, n=1, cutoff=_LIKENESS)
