# SPDX-License-Identifier: Apache-2.0
"""Error texts for values that do not fit their message type.

The encoder finds out that a value does not fit, and this module where and why.
"""

import math
from collections.abc import Callable, Iterable, Mapping
from itertools import islice
from typing import Any, Final

from gateway.codec.cdr.arrays import Array, first_misfit
from gateway.codec.cdr.encoder import Encoder
from gateway.codec.cdr.misfits import MISFITS
from gateway.codec.error_text import CodecError, did_you_mean, truncate
from gateway.codec.error_text import kind as kind_of
from schemas.definition import (
    FLOAT32_OVERFLOW,
    FLOATS,
    INTEGER_RANGES,
    STRINGS,
    Definition,
    FieldType,
)
from schemas.definition_text import text_misfit
from schemas.installed import InstalledDefinitions
from schemas.json_forms import (
    FORMS,
    NON_FINITE,
    Clock,
    NumberArray,
    OctetsError,
    first_fraction,
    octets,
    whole,
)

MAX_PROBLEMS: Final = 3  # as many as a person reads. The others are counted

_EXPECTED: Final = {"bool": "true or false", "string": "a string", "wstring": "a string"}
_KINDS: Final[Mapping[str, frozenset[type]]] = {
    "bool": frozenset({bool}),
    "string": frozenset({str}),
    "wstring": frozenset({str}),
    **dict.fromkeys(INTEGER_RANGES, frozenset({int})),
    **dict.fromkeys(FLOATS, frozenset({float, int})),
}
_NUMBERS: Final = frozenset(_KINDS) - STRINGS
_NAMED: Final = frozenset(map(type, NON_FINITE))
_FORMS: Final[Mapping[str, frozenset[type]]] = {  # those of `_plain`, before
    **_KINDS,
    **dict.fromkeys(INTEGER_RANGES, frozenset({int, float})),
    **dict.fromkeys(FLOATS, frozenset({float, int}) | _NAMED),
}
_FLOAT32_LIMIT: Final = math.nextafter(FLOAT32_OVERFLOW, 0)
_RANGES: Final[Mapping[str, tuple[float, float]]] = {
    **INTEGER_RANGES,
    "float32": (-_FLOAT32_LIMIT, _FLOAT32_LIMIT),
    "float64": (-math.inf, math.inf),
}


class InvalidValueError(CodecError):
    """A value does not fit its message type. ``path`` is the place of its first problem."""

    def __init__(self, path: str, reason: str) -> None:
        super().__init__(reason)
        self.path = path


def explain_misfit(
    value: object,
    definition: Definition,
    definitions: InstalledDefinitions,
    encoder_of: Callable[[str], Encoder],
    now_ns: Clock,
    root: str,
) -> InvalidValueError | None:
    """Return the error about a value that the encoder of *definition* has refused.

    Of each array only the first element that does not fit is named. *root* is the name of the
    value. Return ``None`` if nothing is wrong with it.
    """
    problems = _Problems(definitions, encoder_of, now_ns, root)
    problems.check_message(value, definition, "")
    return problems.error()


class _Problems:
    """The first problems of a value, and the number of all."""

    def __init__(
        self,
        definitions: InstalledDefinitions,
        encoder_of: Callable[[str], Encoder],
        now_ns: Clock,
        root: str,
    ) -> None:
        self._definitions = definitions
        self._encoder_of = encoder_of
        self._now_ns = now_ns
        self._root = root
        self._found: list[tuple[str, str]] = []  # path and reason
        self._count = 0

    def error(self) -> InvalidValueError | None:
        if not self._found:
            return None
        reason = "; ".join(f"{path}: {why}" for path, why in self._found)
        if self._count > MAX_PROBLEMS:
            reason += f" (and {self._count - MAX_PROBLEMS} more)"
        return InvalidValueError(self._found[0][0], reason)

    def check_message(self, value: object, definition: Definition, path: str) -> None:
        form = FORMS.get(definition.name)
        if form is not None:
            value = form(value, self._now_ns)
        if type(value) is not dict:
            self._add(path, f"expected an object, got {kind_of(value)}")
            return
        names = {field.name: None for field in definition.fields}
        for field in definition.fields:
            if field.name in value:
                self._check_field(value[field.name], field.type, f"{path}.{field.name}")
        unknown = [name for name in value if name not in names]
        for name in unknown[:MAX_PROBLEMS]:
            self._add(f"{path}.{name}", _unknown(name, list(names), definition))
        self._count += len(unknown[MAX_PROBLEMS:])

    def _check_field(self, value: object, kind: FieldType, path: str) -> None:
        if kind.is_octets:
            self._check_octets(value, kind, path)
        elif kind.is_array:
            self._check_array(value, kind, path)
        elif kind.is_primitive:
            self._add(path, _misfit(value, kind))
        else:
            self.check_message(value, self._definitions.get(kind.base), path)

    def _check_octets(self, value: object, kind: FieldType, path: str) -> None:
        try:
            self._add(path, _wrong_length(len(octets(value)), kind))
        except OctetsError as error:
            self._add(path, str(error))

    def _check_array(self, values: object, kind: FieldType, path: str) -> None:
        if kind.base == "int8" and isinstance(values, str | bytes):
            self._check_octets(values, kind, path)
            return
        if isinstance(values, NumberArray):
            self._check_numbers(values.values, kind, path)
            return
        if not isinstance(values, list):
            self._add(path, f"expected an array, got {kind_of(values)}")
            return
        wrong_length = _wrong_length(len(values), kind)
        if wrong_length is not None:
            self._add(path, wrong_length)
        elif kind.is_primitive:
            for index in _suspects(values, kind):
                reason = _misfit(values[index], kind)
                if reason is not None:
                    self._add(f"{path}[{index}]", reason)
                    return
        else:
            self._check_elements(values, kind, path)

    def _check_numbers(self, values: Array, kind: FieldType, path: str) -> None:
        wrong_length = _wrong_length(len(values), kind)
        index = first_misfit(values, kind.base) if kind.base in _NUMBERS else 0
        if wrong_length is not None:
            self._add(path, wrong_length)
        elif not kind.is_primitive:
            self.check_message(values[0].item(), self._definitions.get(kind.base), f"{path}[0]")
        elif index is not None:
            value = values[index].item()
            reason = _misfit(value, kind) or f"{value} stands for several integers"
            self._add(f"{path}[{index}]", reason)

    def _check_elements(self, values: list[object], kind: FieldType, path: str) -> None:
        encode = self._encoder_of(kind.base)
        for index, element in enumerate(values):
            try:
                encode(element, self._now_ns)
            except MISFITS:
                definition = self._definitions.get(kind.base)
                self.check_message(element, definition, f"{path}[{index}]")
                return

    def _add(self, path: str, reason: str | None) -> None:
        """Add a problem, unless *reason* is ``None``."""
        if reason is None:
            return
        self._count += 1
        if len(self._found) < MAX_PROBLEMS:
            self._found.append((self._root + truncate(path), reason))


def _suspects(values: list[object], kind: FieldType) -> Iterable[int]:
    """Return the indices of the elements that may not fit: of numbers, one at most.

    A client may send 100,000, so those of a wrong kind or out of range are found without a call
    for each.
    """
    if kind.base in STRINGS:
        return range(len(values))
    types = list(map(type, values))
    kinds = set(types)
    wrong = kinds - _FORMS[kind.base]
    if wrong:
        return (min(map(types.index, wrong)),)
    if str in kinds:
        is_unnamed = [type(value) is str and value not in NON_FINITE for value in values]
        if True in is_unnamed:
            return (is_unnamed.index(True),)
    if float in kinds and kind.base in INTEGER_RANGES:
        fraction = first_fraction(values)
        if fraction is not None:
            return (fraction,)
    numbers: list[Any] = values
    if kinds & _NAMED:
        numbers = [0 if type(value) in _NAMED else value for value in values]
    low, high = _RANGES.get(kind.base, (False, True))
    if not numbers or low <= min(numbers) <= max(numbers) <= high:
        return ()
    outside = (index for index, value in enumerate(numbers) if not low <= value <= high)
    finite = (index for index in outside if math.isfinite(numbers[index]))
    return tuple(islice(finite, 1))


def _plain(value: object, kind: FieldType) -> Any:
    """Return a number in one form: an integer as such, 0 for NaN and infinities."""
    if kind.base in FLOATS:
        if type(value) in _NAMED:
            return 0 if value in NON_FINITE else value
        return 0 if type(value) is float and not math.isfinite(value) else value
    return whole(value) if kind.base in INTEGER_RANGES else value


def _misfit(value: object, kind: FieldType) -> str | None:
    """Return the reason why a value does not fit its type."""
    plain = _plain(value, kind)
    if type(plain) not in _KINDS[kind.base]:
        return f"expected {_EXPECTED.get(kind.base, _number(kind))}, got {kind_of(value)}"
    if kind.base in STRINGS:
        return text_misfit(plain, kind)
    if kind.base == "bool":
        return None
    low, high = _RANGES[kind.base]
    if not low <= plain <= high:
        text = f"{truncate(str(value))} is out of range for {kind.base}"
        return text if kind.base in FLOATS else f"{text} ({low} to {high})"
    return None


def _number(kind: FieldType) -> str:
    return "a number" if kind.base in FLOATS else "an integer"


def _wrong_length(count: int, kind: FieldType) -> str | None:
    if kind.length is not None and count != kind.length:
        return f"expected {kind.length} elements, got {count}"
    if kind.bound is not None and count > kind.bound:
        return f"expected at most {kind.bound} elements, got {count}"
    return None


def _unknown(name: str, names: list[str], definition: Definition) -> str:
    reason = f"unknown field of {definition.title}"
    if not names:
        return f"{reason}, which is empty"
    return reason + (did_you_mean(name, names) or f", which has {truncate(', '.join(names))}")
