# SPDX-License-Identifier: Apache-2.0
"""Error texts for values that do not fit their message type."""

import difflib
from collections.abc import Mapping
from typing import Final

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from gateway.codec.error_text import EXPECTED, MAX_ECHO, truncate
from gateway.codec.error_text import kind as kind_of
from gateway.codec.errors import CodecError
from schemas.definition import FLOATS, INTEGER_RANGES, Definition, Field
from schemas.installed import InstalledDefinitions

MAX_PROBLEMS: Final = 3  # as many as a person reads; the others are counted
_OUT_OF_RANGE: Final = {
    "greater_than": "over {gt}",
    "greater_than_equal": "at least {ge}",
    "less_than": "under {lt}",
    "less_than_equal": "at most {le}",
}
_WRONG_LENGTH: Final = frozenset({"too_short", "too_long", "bytes_too_short", "bytes_too_long"})


class InvalidValueError(CodecError):
    """A value does not fit its message type; ``path`` is the place of its first problem."""

    def __init__(self, path: str, reason: str) -> None:
        super().__init__(reason)
        self.path = path


def invalid_value(
    error: ValidationError, definition: Definition, definitions: InstalledDefinitions, root: str
) -> InvalidValueError:
    """Turn pydantic's error about a value for *definition*, called *root*, into one for clients."""
    details = error.errors(include_url=False)
    texts = _Texts(definition, definitions, root)
    problems = [texts.problem(detail) for detail in details[:MAX_PROBLEMS]]
    reason = "; ".join(problems)
    if len(details) > MAX_PROBLEMS:
        reason += f" (and {len(details) - MAX_PROBLEMS} more)"
    return InvalidValueError(texts.path(details[0]), reason)


class _Texts:
    def __init__(
        self, definition: Definition, definitions: InstalledDefinitions, root: str
    ) -> None:
        self._definition = definition
        self._definitions = definitions
        self._root = root

    def path(self, detail: ErrorDetails) -> str:
        """Return the path to the value, such as ``msg.poses[3].position.x``."""
        parts = [f"[{part}]" if isinstance(part, int) else f".{part}" for part in detail["loc"]]
        return self._root + truncate("".join(parts))

    def problem(self, detail: ErrorDetails) -> str:
        return f"{self.path(detail)}: {self._reason(detail)}"

    def _reason(self, detail: ErrorDetails) -> str:
        kind = detail["type"]
        value = detail["input"]
        container, field = self._field(detail)
        if kind == "extra_forbidden":
            return _unknown(str(detail["loc"][-1]), container)
        if kind in EXPECTED:
            return f"expected {EXPECTED[kind]}, got {kind_of(value)}"
        if kind in _OUT_OF_RANGE and field is not None:
            return _out_of_range(value, field.type.base, kind, detail.get("ctx", {}))
        if kind in _WRONG_LENGTH and field is not None and isinstance(value, (list, bytes)):
            wanted = field.type.length
            expected = f"{wanted}" if wanted is not None else f"at most {field.type.bound}"
            return f"expected {expected} elements, got {len(value)}"
        if kind == "string_pattern_mismatch":
            return "a string cannot hold U+0000"
        if kind == "string_unicode":
            return "a string cannot hold a lone surrogate"
        # The models' own checks have texts for clients already.
        return truncate(detail["msg"][:1].lower() + detail["msg"][1:])

    def _field(self, detail: ErrorDetails) -> tuple[Definition, Field | None]:
        """Return the innermost message around the value, and the field that contains the value."""
        container = self._definition
        field = None
        for name in detail["loc"]:
            if isinstance(name, int):
                continue
            if field is not None:
                container = self._definitions.get(field.type.base)
            field = next((field for field in container.fields if field.name == name), None)
            if field is None:
                break
        return container, field


def _unknown(name: str, definition: Definition) -> str:
    reason = f"unknown field of {definition.title}"
    names = [field.name for field in definition.fields]
    # Comparing takes the product of the lengths.
    close = difflib.get_close_matches(name[:MAX_ECHO], names, n=1)
    if close:
        return f"{reason}; did you mean {close[0]}?"
    return (
        f"{reason}, which has {truncate(', '.join(names))}"
        if names
        else f"{reason}, which is empty"
    )


def _out_of_range(value: object, base: str, kind: str, limits: Mapping[str, object]) -> str:
    reason = f"{truncate(str(value))} is out of range for {base}"
    if base in FLOATS:
        return reason
    low, high = INTEGER_RANGES[base]
    if {low, high}.isdisjoint(limits.values()):  # narrower than the type
        return f"{truncate(str(value))} is out of range, {_OUT_OF_RANGE[kind].format(**limits)}"
    return f"{reason} ({low} to {high})"
