# SPDX-License-Identifier: Apache-2.0
"""Random valid messages of any type, and the forms in which others hold them.

The plain form is what everything is compared in: dicts in the order of the definition, lists,
``bytes`` for octet arrays, floats that their type can hold exactly.
"""

import importlib
import random
import struct
from types import SimpleNamespace
from typing import Any

import numpy as np
import pybase64

from schemas.definition import INTEGER_RANGES, Definition, FieldType
from schemas.installed import InstalledDefinitions
from schemas.naming import attribute

Plain = dict[str, Any]

_TEXTS = ("", "odom", "base_link", "grüße", "ハローワールド", "\U0001f916", 'a"b\\c\n\t', "x" * 40)


class RandomMessages:
    """Makes messages out of a seed. Most arrays are short, some are long."""

    def __init__(self, definitions: InstalledDefinitions, seed: int, longest: int = 4) -> None:
        self._definitions = definitions
        self._random = random.Random(seed)
        self._longest = longest

    def message(self, name: str) -> Plain:
        return {field.name: self._value(field.type) for field in self._definitions.get(name).fields}

    def _value(self, kind: FieldType) -> Any:
        if not kind.is_array:
            return self._scalar(kind)
        length = kind.length if kind.length is not None else self._length(kind)
        if kind.is_octets:
            return self._random.randbytes(length)
        return [self._scalar(kind) for _ in range(length)]

    def _length(self, kind: FieldType) -> int:
        longest = self._longest
        if kind.is_primitive and self._random.random() < 0.2:
            longest = 60
        return self._random.randint(0, longest if kind.bound is None else min(longest, kind.bound))

    def _scalar(self, kind: FieldType) -> Any:
        choose = self._random.choice
        if kind.base == "bool":
            return choose([False, True])
        if kind.base in INTEGER_RANGES:
            low, high = INTEGER_RANGES[kind.base]
            return choose([low, high, 0, self._random.randint(low, high)])
        if kind.base == "float64":
            return choose([0.0, 0.1, -1e300, 5e-324, self._random.gauss(0, 100)])
        if kind.base == "float32":
            return to_float32(choose([0.0, 0.1, 1e30, self._random.gauss(0, 100)]))
        if kind.base in {"string", "wstring"}:
            bound = kind.string_bound
            return choose([text for text in _TEXTS if bound is None or len(text.encode()) <= bound])
        return self.message(kind.base)


def to_float32(value: float) -> float:
    return struct.unpack("<f", struct.pack("<f", value))[0]


def normalized(value: Any) -> Any:
    """Turn what a decoder returns into plain lists."""
    match value:
        case dict():
            return {key: normalized(item) for key, item in value.items()}
        case np.ndarray():
            return value.tolist()
        case list() | tuple():
            return [normalized(item) for item in value]
    return value


def to_json(value: Any) -> Any:
    """Turn the plain form into what JSON holds: octets as base64."""
    match value:
        case dict():
            return {key: to_json(item) for key, item in value.items()}
        case list():
            return [to_json(item) for item in value]
        case bytes():
            return pybase64.b64encode(value).decode()
    return value


def to_objects(value: Any) -> Any:
    """Turn the plain form into objects with the attributes of our models."""
    match value:
        case dict():
            items = {attribute(key): to_objects(item) for key, item in value.items()}
            return SimpleNamespace(**items)
        case list():
            return [to_objects(item) for item in value]
    return value


def ros_class(name: str) -> Any:
    package, kind, short = name.split("/")
    outer, _, part = short.partition("_")  # no message has an underscore in its name
    found = getattr(importlib.import_module(f"{package}.{kind}"), outer)
    return getattr(found, part) if part else found


def to_ros(definition: Definition, definitions: InstalledDefinitions, values: Plain) -> Any:
    """Turn the plain form into a message of rclpy."""

    def one(kind: FieldType, value: Any) -> Any:
        if kind.base == "byte":
            return bytes([value])
        if kind.is_primitive:
            return value
        return to_ros(definitions.get(kind.base), definitions, value)

    message = ros_class(definition.name)()
    for field in definition.fields:
        value = values[field.name]
        if field.type.is_array:
            value = [one(field.type, item) for item in value]
        else:
            value = one(field.type, value)
        setattr(message, field.name, value)
    return message


def from_ros(definition: Definition, definitions: InstalledDefinitions, message: Any) -> Plain:
    """Turn a message of rclpy, or one of rosbags, into the plain form."""

    def one(kind: FieldType, value: Any) -> Any:
        if not kind.is_primitive:
            return from_ros(definitions.get(kind.base), definitions, value)
        if kind.base == "byte":  # rclpy holds it as bytes, rosbags as a signed integer
            return value[0] if isinstance(value, bytes) else int(value) & 0xFF
        return value.item() if isinstance(value, np.generic) else value

    values = {}
    for field in definition.fields:
        value = getattr(message, field.name)
        if field.type.is_array:
            items = [one(field.type, item) for item in value]
            values[field.name] = bytes(items) if field.type.is_octets else items
        else:
            values[field.name] = one(field.type, value)
    return values
