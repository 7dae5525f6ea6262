# SPDX-License-Identifier: Apache-2.0
"""What a decoder makes of a message, as pieces of Python source."""

import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Final, Literal, Protocol, TypeVar

import numpy as np
from pybase64 import b64encode_as_string

from gateway.codec.cdr.layout import CODES, NUMPY_LENGTH, ByteOrder, Numbers
from gateway.codec.cdr.source import Source
from schemas.definition import FieldType

Octets = Literal["base64", "raw"]

_NATIVE: Final = "<" if sys.byteorder == "little" else ">"

Value = TypeVar("Value")


class Target(Protocol[Value]):
    """Writes what becomes of the fields that were read; a *Value* stands for one of them.

    The source it returns may use the decoder's variables ``data``, ``offset``, ``end`` and
    ``count`` where arrays are read, but only the fields' own where values are put together.
    """

    @property
    def names(self) -> Mapping[str, object]:
        """The globals that the source uses."""

    @property
    def takes_tuples(self) -> bool:
        """Whether short fixed arrays of numbers are wanted as tuples rather than by `numbers`."""

    def octets(self, octets: str) -> str:
        """Return what to keep of an array of octets, given the source of its bytes or a view."""

    def numbers(self, member: Numbers, order: ByteOrder, source: Source) -> str:
        """Return what to keep of the ``count`` numbers or booleans at ``offset``."""

    def value(self, kind: FieldType, name: str) -> Value:
        """Return a field that is in the variable *name*, a list where it has such elements."""

    def message(self, members: Sequence[tuple[str, Value]]) -> Value:
        """Return a message with these members."""

    def expression(self, value: Value, source: Source) -> str:
        """Return the source that makes a value."""


class Values:
    """Makes dicts that `gateway.codec.json.dumps` can write."""

    takes_tuples = True

    def __init__(self, octets: Octets) -> None:
        self._octets = octets
        self.names: Mapping[str, Callable[..., object]] = {
            "base64": b64encode_as_string,
            "frombuffer": np.frombuffer,
        }

    def octets(self, octets: str) -> str:
        """Make base64, or a view."""
        if self._octets == "base64":
            return f"base64({octets})"
        return octets if octets.startswith("memoryview") else f"memoryview({octets})"

    def numbers(self, member: Numbers, order: ByteOrder, source: Source) -> str:
        """Make a numpy view, or a tuple where that is faster."""
        code = CODES[member.base]
        if member.base == "bool":
            # Any octet but 0 is true, and a view must not show octets as bools that are neither.
            view = '(frombuffer(data, "u1", count, offset) != 0)'
        else:
            wire = np.dtype(f"{order}{code}")
            dtype = source.constant(member.base.upper(), wire, wire.str)
            view = f"frombuffer(data, {dtype}, count, offset)"
            if order != _NATIVE:  # orjson writes arrays in native order only
                view += f'.astype("={code}")'
        if member.length is not None:
            return view
        few = f'unpack_from(f"{order}{{count}}{code}", data, offset)'
        return f"({view} if count > {NUMPY_LENGTH} else {few}) if count else ()"

    def value(self, kind: FieldType, name: str) -> str:
        """Take it as it is."""
        del kind
        return name

    def message(self, members: Sequence[tuple[str, str]]) -> str:
        """Make a dict."""
        entries = [f'"{name}": {value}' for name, value in members]
        return f"{{{', '.join(entries)}}}"

    def expression(self, value: str, source: Source) -> str:
        """Take the source as it is."""
        del source
        return value
