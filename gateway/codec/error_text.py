# SPDX-License-Identifier: Apache-2.0
"""The exceptions of the codecs, and error texts for values that clients sent."""

import difflib
import json
from collections.abc import Container, Iterable, Mapping
from typing import Final

MAX_EDITS: Final = 2  # of a name that is misspelt. Beyond it is another one
MAX_ECHO: Final = 128  # characters of a client's own text that come back. Logs stay readable

# by pydantic's name of the error
EXPECTED: Final = {
    "bool_type": "true or false",
    "dict_type": "an object",
    "finite_number": "a finite number",
    "float_type": "a number",
    "int_type": "an integer",
    "list_type": "an array",
    "model_attributes_type": "an object",
    "model_type": "an object",
    "string_type": "a string",
    "tuple_type": "an array",
}


class CodecError(ValueError):
    """Bytes or a value do not fit the type. ``offset`` is the position in the bytes, if known."""

    def __init__(self, reason: str, *, offset: int | None = None) -> None:
        super().__init__(reason)
        self.offset = offset


class FieldError(CodecError):
    """A path names no field of a message type. The text lists the fields."""


class JsonError(CodecError):
    """A client sent something else than the JSON it may send. The text says where and why."""


def kind(value: object) -> str:
    """Name the kind of a value of JSON or CBOR. Of numbers and booleans, the value."""
    match value:
        case None:
            return "null"
        case bool():
            return "true" if value else "false"
        case int() | float():
            return truncate(json.dumps(value))
        case str():
            return "a string"
        case bytes():
            return "a byte string"
        case list() | tuple():
            return "an array"
        case Mapping():
            return "an object"
    return type(value).__name__


def truncate(text: str) -> str:
    """Shorten a client's own text for an error text."""
    return text if len(text) <= MAX_ECHO else f"{text[: MAX_ECHO - 3]}..."


def nearest(name: str, known: Iterable[str]) -> str | None:
    """Return the known name that a client's unknown one was perhaps meant to be."""
    # Comparing takes the product of the lengths.
    near = difflib.get_close_matches(name[:MAX_ECHO], known, n=1)
    return near[0] if near else None


def misspelt(name: str, known: Iterable[str]) -> str | None:
    """Return the known name of which an unknown one is a misspelling.

    It is two edits away at most, and fewer than half of the name: one from `args`, none from `id`.
    """
    near = nearest(name, known)
    if near is None or _edits(name, near) > min(MAX_EDITS, (len(near) - 1) // 2):
        return None
    return near


def _edits(one: str, other: str) -> int:
    """Count the letters to insert, delete, replace or swap with the next one."""
    before: list[int] = []
    last = list(range(len(other) + 1))
    for i, letter in enumerate(one, 1):
        row = [i]
        for j, wanted in enumerate(other, 1):
            count = min(last[j] + 1, row[j - 1] + 1, last[j - 1] + (letter != wanted))
            if i > 1 < j and letter == other[j - 2] and one[i - 2] == wanted:
                count = min(count, before[j - 2] + 1)
            row.append(count)
        before, last = last, row
    return last[-1]


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return the end of a text on a client's unknown name: ``"; did you mean odom?"``, or none."""
    return suggestion(nearest(name, known))


def suggestion(near: str | None) -> str:
    """Return the end of a text on an unknown name, with the one that was perhaps meant."""
    return f"; did you mean {near}?" if near else ""


def hint(name: str, known: Iterable[str], *, given: Container[str] = ()) -> str:
    """Return the end of such a text: the nearest known name, or all of them.

    A name that is *given* already was not meant. If that is the nearest, all are named.
    """
    near = nearest(name, known)
    if near is None or near in given:
        return f"; known are {', '.join(known)}"
    return suggestion(near)
