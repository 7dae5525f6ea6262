# SPDX-License-Identifier: Apache-2.0
"""The output of a decoder, as pieces of Python source."""

import sys
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from typing import Final, Generic, Literal, TypeVar

import numpy as np
from pybase64 import b64encode_as_string

from gateway.codec.cdr.layout import CODES, NUMPY_LENGTH, ByteOrder, Numbers
from gateway.codec.cdr.sliced_elements import JsonElements
from gateway.codec.cdr.source import SourceCode
from schemas.definition import FieldType

Octets = Literal["base64", "raw"]

NATIVE: Final = "<" if sys.byteorder == "little" else ">"

Value = TypeVar("Value")


class Target(Generic[Value]):
    """Writes the source that makes output of the fields read. A *Value* stands for one field.

    Source that reads arrays may use the decoder's variables ``data``, ``offset``, ``end`` and
    ``count``. Source that builds values only those of the fields.
    """

    names: Mapping[str, object]  # the globals that the source uses
    # Short fixed arrays of numbers are made as tuples rather than by `numbers`.
    takes_tuples = False
    # A float32 is made as a `numpy.float32`, and short fixed arrays as arrays of them.
    keeps_float32 = False
    # The function is a generator, and yields an empty piece between slices of its work.
    pauses = False
    arguments: Sequence[str] = ()  # further ones of the function
    # The source that makes what collects the elements of an array, if the function pauses.
    elements = "[]"

    @abstractmethod
    def octets(self, octets: str) -> str:
        """Return the source for an array of octets, given the source of its bytes or a view."""

    @abstractmethod
    def numbers(self, member: Numbers, order: ByteOrder, source: SourceCode) -> str:
        """Return the source for the ``count`` numbers or booleans at ``offset``."""

    @abstractmethod
    def value(self, kind: FieldType, name: str) -> Value:
        """Return the value of the field in the variable *name*, a list if it is an array."""

    @abstractmethod
    def message(self, members: Sequence[tuple[str, Value]]) -> Value:
        """Return a message with these members."""

    @abstractmethod
    def expression(self, value: Value, source: SourceCode) -> str:
        """Return the source that makes a value."""

    def result(self, value: Value, source: SourceCode) -> str:
        """Return the source that makes what the function returns of the whole message."""
        return self.expression(value, source)


class Values(Target[str]):
    """Makes dicts that `gateway.codec.json.dumps` can write."""

    takes_tuples = True
    # A Python float holds 0.1f as 0.10000000149011612, and would be written so. To orjson a
    # float32 is one, with the digits that it needs, and arrays of any length read the same.
    keeps_float32 = True

    def __init__(self, octets: Octets) -> None:
        self._octets = octets
        self.names = {
            "base64": b64encode_as_string,
            "frombuffer": np.frombuffer,
        }

    def octets(self, octets: str) -> str:
        """Make base64, or a view."""
        if self._octets == "base64":
            return f"base64({octets})"
        return octets if octets.startswith("memoryview") else f"memoryview({octets})"

    def numbers(self, member: Numbers, order: ByteOrder, source: SourceCode) -> str:
        """Make a numpy view, or a tuple if that is faster."""
        code = CODES[member.base]
        if member.base == "bool":
            # Any octet but 0 is true, and a view must not show other octets as bools.
            view = '(frombuffer(data, "u1", count, offset) != 0)'
        else:
            wire = np.dtype(f"{order}{code}")
            dtype = source.constant(member.base.upper(), wire, wire.str)
            view = f"frombuffer(data, {dtype}, count, offset)"
            if order != NATIVE:  # orjson writes arrays in native order only
                view += f'.astype("={code}")'
        if member.length is not None:
            return view
        if member.base == "float32":
            return f"{view} if count else ()"
        few = f'unpack_from(f"{order}{{count}}{code}", data, offset)'
        return f"({view} if count > {NUMPY_LENGTH} else {few}) if count else ()"

    def value(self, kind: FieldType, name: str) -> str:
        """Return it unchanged."""
        del kind
        return name

    def message(self, members: Sequence[tuple[str, str]]) -> str:
        """Make a dict."""
        entries = [f'"{name}": {value}' for name, value in members]
        return f"{{{', '.join(entries)}}}"

    def expression(self, value: str, source: SourceCode) -> str:
        """Return the source unchanged."""
        del source
        return value


class SlicedValues(Values):
    """Makes dicts for `gateway.codec.json_slices.json_slices`, in slices."""

    pauses = True
    arguments = ("write",)
    elements = "JsonElements(write)"

    def __init__(self) -> None:
        super().__init__("raw")
        self.names = {**self.names, "JsonElements": JsonElements}
