# SPDX-License-Identifier: Apache-2.0
"""The values of fields that a message leaves out, and the CDR of an empty element."""

from collections.abc import Sequence
from dataclasses import replace
from struct import calcsize, pack
from typing import Any, Final

from gateway.codec.cdr.layout import CODES, HEADER_BYTES, Elements, Fixed, Member, Numbers, Text
from gateway.codec.cdr.text import to_cdr

_ZEROS: Final = {"bool": False, "float32": 0.0, "float64": 0.0}


def default_value(member: Fixed | Numbers | Text) -> Any:
    """Return the value of a field that is left out: bytes for octets, a list for other arrays."""
    if isinstance(member, Text):
        return member.default or ""
    zero = _ZEROS.get(member.base, 0)
    if isinstance(member, Fixed) and member.length is None:
        return zero if member.default is None else member.default
    values = member.default if isinstance(member.default, tuple) else (zero,) * (member.length or 0)
    return bytes(map(int, values)) if member.is_octets else list(values)


def default_elements(member: Elements) -> list[Any]:
    """Return the elements of an array that is left out. An empty message is ``{}``."""
    if isinstance(member.default, tuple):
        return list(member.default)
    return [{} if member.definition else ""] * (member.length or 0)


class DefaultBytes(dict[int, bytes]):
    """The CDR of an element without fields, by its offset modulo 8."""

    def __init__(self, members: Sequence[Member]) -> None:
        super().__init__()
        self._members = members

    def __missing__(self, residue: int) -> bytes:
        # Padding depends on the offset modulo 8 alone: write behind as many bytes.
        out = bytearray(residue)
        _append(out, self._members)
        self[residue] = written = bytes(out[residue:])
        return written


def _append(out: bytearray, members: Sequence[Member]) -> None:
    for member in members:
        match member:
            case Text():
                _append_text(out, member, default_value(member))
            case Elements():
                elements = default_elements(member)
                if member.length is None:
                    _append_numbers(out, "I", [len(elements)])
                for element in elements:
                    if isinstance(element, str):
                        _append(out, [replace(each, default=element) for each in member.members])
                    else:
                        _append(out, member.members)
            case Fixed() | Numbers():
                values = default_value(member)
                if isinstance(member, Numbers) and member.length is None:
                    _append_numbers(out, "I", [len(values)])
                is_one = isinstance(member, Fixed) and member.length is None
                _append_numbers(out, CODES[member.base], [values] if is_one else values)


def _append_text(out: bytearray, member: Text, text: str) -> None:
    count, data = to_cdr(text, is_wide=member.is_wide)
    _append_numbers(out, "I", [count])
    out += data


def _append_numbers(out: bytearray, code: str, values: Sequence[object]) -> None:
    if values:  # before none there is no padding
        out += bytes((HEADER_BYTES - len(out)) % calcsize(f"<{code}"))
        out += pack(f"<{len(values)}{code}", *values)
