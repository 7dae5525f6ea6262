# SPDX-License-Identifier: Apache-2.0
"""rclpy's message objects: built from plain values, and written as one line of text."""

import array
import importlib
import json
import re
from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np

from schemas.definition import FieldType
from schemas.installed import InstalledDefinitions

_SHOWN_ELEMENTS: Final = 8  # of an array, so that a line stays readable
_SHOWN_CHARACTERS: Final = 80  # of a string
_MAX_LINE: Final = 2000  # characters: 20 lines of a terminal
# that of .msg files is a uint8 in IDL
_IDL_CHAR: Final = re.compile(r"char(\[\d+\])?|sequence<char(, \d+)?>")


def message_class(name: str) -> Any:
    """Import the class of ``pkg/msg/Name``.

    Raises:
        ImportError: its package is not installed for this Python.
    """
    package, _, short = name.split("/")
    try:
        return getattr(importlib.import_module(f"{package}.msg"), short)
    except AttributeError as error:
        raise ImportError(f"package {package} has no message {short}") from error


class Builder:
    """Builds message objects from dicts by field name, with octets as `bytes`."""

    def __init__(self, definitions: InstalledDefinitions) -> None:
        self._definitions = definitions
        self._classes: dict[str, Any] = {}

    def build(self, name: str, values: Mapping[str, Any]) -> Any:
        """Build an object of the class of ``pkg/msg/Name``.

        Raises:
            ImportError: its package is not installed for this Python.
        """
        cls = self._classes.get(name)
        if cls is None:
            cls = self._classes[name] = message_class(name)
        types = {field.name: field.type for field in self._definitions.get(name).fields}
        members = {key: self._value(types[key], value) for key, value in values.items()}
        for key, in_idl in cls.get_fields_and_field_types().items():
            if key in members and _IDL_CHAR.fullmatch(in_idl):
                members[key] = _as_text(values[key])
        return cls(**members)

    def _value(self, kind: FieldType, value: Any) -> Any:
        if kind.is_array:
            if kind.base in {"uint8", "char"}:
                # in rclpy a fixed array is of numpy, a sequence of array
                return array.array("B", value) if kind.is_sequence else np.frombuffer(value, "u1")
            return [self._one(kind.base, element) for element in value]
        return self._one(kind.base, value)

    def _one(self, base: str, value: Any) -> Any:
        if base == "byte":
            return bytes((value,))
        return self.build(base, value) if "/" in base else value


def _as_text(value: Any) -> Any:
    """Turn a char of IDL, or several, into text. For rclpy it must be ASCII."""
    if isinstance(value, int):
        return chr(value & 0x7F)
    return [_as_text(each) for each in value]


def one_line(message: Any) -> str:
    """Write a message as a short YAML flow mapping, safe to show on a terminal."""
    line = _short(message)
    return line if len(line) <= _MAX_LINE else f"{line[:_MAX_LINE]} ..."


def _short(value: Any) -> str:
    match value:
        case str():
            text = value if len(value) <= _SHOWN_CHARACTERS else f"{value[:_SHOWN_CHARACTERS]}..."
            # a peer's control characters would reach the terminal
            return json.dumps(text, ensure_ascii=not text.isprintable())
        case bool():
            return "true" if value else "false"
        case float() | np.floating():
            return f"{value:.7g}"
        case bytes() if len(value) == 1:
            return str(value[0])
        case Sequence() | np.ndarray() | array.array():
            shown = ", ".join(_short(element) for element in value[:_SHOWN_ELEMENTS])
            more = f", ... {len(value)} in all" if len(value) > _SHOWN_ELEMENTS else ""
            return f"[{shown}{more}]"
        case _ if hasattr(value, "get_fields_and_field_types"):
            fields = value.get_fields_and_field_types()
            return "{" + ", ".join(f"{n}: {_short(getattr(value, n))}" for n in fields) + "}"
        case _:
            return str(value)
