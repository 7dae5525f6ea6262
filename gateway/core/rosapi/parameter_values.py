# SPDX-License-Identifier: Apache-2.0
"""The values of parameters: rcl_interfaces/msg/ParameterValue to JSON and back."""

from collections.abc import Callable, Mapping
from contextlib import suppress
from enum import IntEnum
from typing import Any, Final

from gateway.codec.error_text import kind
from gateway.codec.nonfinite import named
from schemas.definition import INTEGER_RANGES
from schemas.json_forms import NON_FINITE, OctetsError, octets


class ParameterType(IntEnum):
    """The constants of rcl_interfaces/msg/ParameterType."""

    NOT_SET = 0
    BOOL = 1
    INTEGER = 2
    DOUBLE = 3
    STRING = 4
    BYTE_ARRAY = 5
    BOOL_ARRAY = 6
    INTEGER_ARRAY = 7
    DOUBLE_ARRAY = 8
    STRING_ARRAY = 9

    @classmethod
    def _missing_(cls, value: object) -> "ParameterType":
        return cls.NOT_SET  # a type of a later ROS means nothing to us


_ELEMENTS: Final = {
    ParameterType.BOOL_ARRAY: ParameterType.BOOL,
    ParameterType.INTEGER_ARRAY: ParameterType.INTEGER,
    ParameterType.DOUBLE_ARRAY: ParameterType.DOUBLE,
    ParameterType.STRING_ARRAY: ParameterType.STRING,
}
_ARRAYS: Final = {element: array for array, element in _ELEMENTS.items()}
_LOWEST, _HIGHEST = INTEGER_RANGES["int64"]


class ParameterValueError(ValueError):
    """A value does not fit the type of a parameter. The text says what was expected."""


def type_word(number: int) -> str:
    """Return the name of a type of parameter: ``double_array``."""
    return ParameterType(number).name.lower()


def value_of(message: Mapping[str, Any]) -> object:
    """Return the value in a decoded ParameterValue. ``None`` means that it is not set.

    Bytes are base64, NaN and infinities are named, as null means that there is no value.
    `gateway.codec.json.dumps` takes all of it.
    """
    return named(message.get(f"{type_word(message['type'])}_value"), "string")


def message_of(value: object, wanted: ParameterType) -> dict[str, object]:
    """Return a ParameterValue of type *wanted*, or of the value's own type for ``NOT_SET``.

    ``None`` means that the parameter is not set. Integers are accepted as doubles, and doubles
    without a fraction as integers: JSON, and JavaScript even more so, hardly distinguishes them.

    Raises:
        ParameterValueError: the value does not fit.
    """
    if value is None:
        return {"type": int(ParameterType.NOT_SET)}
    type_ = wanted if wanted is not ParameterType.NOT_SET else _own_type(value)
    return {"type": int(type_), f"{type_word(type_)}_value": _converted(value, type_)}


def fitted(value: object, descriptor: Mapping[str, Any] | None) -> dict[str, object]:
    """Return the ParameterValue for a parameter with this descriptor, or without (undeclared)."""
    if descriptor is None:
        return message_of(value, ParameterType.NOT_SET)
    try:
        return message_of(value, ParameterType(descriptor["type"]))
    except ParameterValueError:
        if not descriptor["dynamic_typing"]:
            raise
        return message_of(value, ParameterType.NOT_SET)


def description(descriptor: Mapping[str, Any]) -> dict[str, object]:
    """Return a ParameterDescriptor as clients get it."""
    described: dict[str, object] = {
        "type": type_word(descriptor["type"]),
        "description": descriptor["description"],
        "additional_constraints": descriptor["additional_constraints"],
        "read_only": descriptor["read_only"],
        "dynamic_typing": descriptor["dynamic_typing"],
    }
    for limits in (*descriptor["integer_range"], *descriptor["floating_point_range"]):
        bounds = {
            "from": limits["from_value"],
            "to": limits["to_value"],
            "step": limits["step"],
        }
        described["range"] = named(bounds, "string")
    return described


def _own_type(value: object) -> ParameterType:
    match value:
        case list():
            return _own_array_type(value)
        case bool():
            return ParameterType.BOOL
        case int():
            return ParameterType.INTEGER
        case float():
            return ParameterType.DOUBLE
        case str():
            return ParameterType.STRING
        case bytes():  # in CBOR
            return ParameterType.BYTE_ARRAY
    raise ParameterValueError(
        f"expected a boolean, a number, a string or an array of one of these, got {kind(value)}"
    )


def _own_array_type(values: list[object]) -> ParameterType:
    types = {_own_type(value) for value in values}
    if types == {ParameterType.INTEGER, ParameterType.DOUBLE}:
        return ParameterType.DOUBLE_ARRAY
    if len(types) == 1:
        (only,) = types
        if only in _ARRAYS:
            return _ARRAYS[only]
    if not types:
        raise ParameterValueError("an empty array has no type, and the node states none")
    raise ParameterValueError("expected an array of values of one kind")


def _converted(value: object, type_: ParameterType) -> object:
    if type_ is ParameterType.BYTE_ARRAY:
        return _bytes(value)
    if type_ not in _ELEMENTS:
        return _scalar(value, type_)
    if not isinstance(value, list):
        raise ParameterValueError(f"expected an array, got {kind(value)}")
    element_type = _ELEMENTS[type_]
    return [_element(index, element, element_type) for index, element in enumerate(value)]


def _element(index: int, value: object, type_: ParameterType) -> object:
    if value is None and type_ is ParameterType.DOUBLE:
        return None  # NaN, as everywhere
    try:
        return _scalar(value, type_)
    except ParameterValueError as error:
        raise ParameterValueError(f"[{index}]: {error}") from None


def _scalar(value: object, type_: ParameterType) -> object:
    convert, expected = _SCALARS[type_]
    converted = convert(value)
    if converted is None:
        raise ParameterValueError(f"expected {expected}, got {kind(value)}")
    return converted


def _boolean(value: object) -> bool | None:
    return value if isinstance(value, bool) else None


def _integer(value: object) -> int | None:
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    if isinstance(value, bool) or not isinstance(value, int):
        return None
    return value if _LOWEST <= value <= _HIGHEST else None


def _double(value: object) -> float | None:
    if isinstance(value, str):
        return NON_FINITE.get(value)
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return None
    try:
        return float(value)
    except OverflowError:  # an integer of over 300 digits
        return None


def _text(value: object) -> str | None:
    return value if isinstance(value, str) and "\0" not in value else None


def _bytes(value: object) -> bytes:
    with suppress(OctetsError):
        return octets(value)
    raise ParameterValueError("expected bytes: base64 or an array of integers from 0 to 255")


_SCALARS: Final[Mapping[ParameterType, tuple[Callable[[object], object], str]]] = {
    ParameterType.BOOL: (_boolean, "true or false"),
    ParameterType.INTEGER: (_integer, "an integer of 64 bits"),
    ParameterType.DOUBLE: (_double, 'a number, "NaN", "Infinity" or "-Infinity"'),
    ParameterType.STRING: (_text, "a string without U+0000"),
}
