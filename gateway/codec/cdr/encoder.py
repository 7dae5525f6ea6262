# SPDX-License-Identifier: Apache-2.0
"""Validated messages to CDR."""

import math
from collections.abc import Callable, Sequence
from functools import cache
from struct import error as StructError  # noqa: N812
from struct import pack
from typing import Any, Final, TypeAlias, assert_never

import numpy as np

from gateway.codec.cdr.layout import (
    CODES,
    HEADER_BYTES,
    Elements,
    Fixed,
    Member,
    Numbers,
    Path,
    Run,
    Slot,
    Text,
    flatten,
    item_path,
)
from gateway.codec.cdr.source import SourceCode, variable
from gateway.codec.errors import CodecError
from schemas.definition import FLOATS, Definition
from schemas.installed import InstalledDefinitions
from schemas.naming import attribute

Encoder: TypeAlias = Callable[[Any], bytes]

_CDR_LE: Final = b"\0\1\0\0"  # RTPS 2.5, 10.2; the options stay 0
# The errors of struct, str.encode and len for a value of a wrong type.
_MISFITS: Final = (StructError, TypeError, UnicodeEncodeError, OverflowError)


def compile_encoder(definition: Definition, definitions: InstalledDefinitions) -> Encoder:
    """Compile a function from a message object to little-endian CDR, header included.

    It reads the attributes that `schemas.naming.attribute` names: numbers, `str`, `bytes` for
    octet arrays, sequences, nested objects. ``None`` for a float is encoded as NaN. Padding is
    zero. The values must have been validated; lengths are checked nevertheless, and a value
    without an encoding raises `CodecError`.

    Raises:
        UnknownTypeError: a nested type is not installed.
    """
    members = flatten(definition, definitions)
    title = f"CDR encoder of {definition.name}"

    def refuse(_message: object, error: Exception) -> bytes:
        raise CodecError(f"{definition.title} cannot be encoded: {error}") from error

    @cache
    def with_nan() -> Encoder:
        return _EncoderWriter(is_lenient=True).write(members, f"{title}, null as NaN", refuse)

    def retry(message: object, _error: Exception) -> bytes:
        return with_nan()(message)

    return _EncoderWriter(is_lenient=False).write(members, title, retry)


def _float(value: float | None) -> float:
    return math.nan if value is None else value


def _wide(text: str) -> bytes:
    """Encode as UTF-16 units of 4 bytes each, as Fast CDR does for a wstring."""
    return np.frombuffer(text.encode("utf-16-le"), "<u2").astype("<u4").tobytes()


def _bad_length(path: str, count: int, expected: str) -> CodecError:
    return CodecError(f"{path} has {count} elements, expected {expected}")


class _EncoderWriter:
    """Writes the source of one encoder: ``out`` grows, run by run.

    The lenient encoder accepts ``None`` as a float. A check at every float would slow down all
    messages for the sake of few, so the strict encoder runs first and the lenient one if it fails.
    """

    def __init__(self, *, is_lenient: bool) -> None:
        self._is_lenient = is_lenient
        self._source = SourceCode()
        self._slots = [Slot("s", HEADER_BYTES)]
        self._values = ["CDR_LE"]
        self._residue: int | None = 0  # of the length of out modulo 8, if known
        self._is_begun = False
        self._objects: dict[Path, str] = {(): "message"}  # those that a variable holds already

    def write(
        self, members: Sequence[Member], title: str, on_misfit: Callable[[object, Exception], bytes]
    ) -> Encoder:
        source = self._source
        with source.block("def encode(message):"):
            with source.block("try:"):
                self._members(members)
                self._flush()
                source.line("return bytes(out)")
            with source.block("except MISFITS as error:"):
                source.line("return on_misfit(message, error)")
        names = {
            "CDR_LE": _CDR_LE,
            "MISFITS": _MISFITS,
            "bad_length": _bad_length,
            "number": _float,
            "on_misfit": on_misfit,
            "pack": pack,
            "wide": _wide,
        }
        return source.compile("encode", title, names)

    def _members(self, members: Sequence[Member]) -> None:
        for member in members:
            match member:
                case Fixed():
                    self._fixed(member)
                case Text():
                    self._text(member)
                case Numbers():
                    self._numbers(member)
                case Elements():
                    self._elements(member)
                case _:
                    assert_never(member)

    def _fixed(self, member: Fixed) -> None:
        code = CODES[member.base]
        if not member.wanted:
            self._slots.append(Slot(code, is_padding=True))
        elif member.length is None:
            self._slots.append(Slot(code))
            value = self._value(member.path)
            self._values.append(f"number({value})" if self._may_be_none(member) else value)
        else:
            name = self._object(member.path)
            self._expect_length(member.path, name, member.length)
            if member.is_octets:
                self._slots.append(Slot("s", member.length))
                self._values.append(name)
            else:
                self._slots.append(Slot(code, member.length))
                self._values.append(self._unpacked(member, name))

    def _text(self, member: Text) -> None:
        source = self._source
        name = variable(member.path)
        value = self._value(member.path)
        if member.is_wide:
            source.line(f"{name} = wide({value})")
            self._count(f"len({name}) // 4", member.path, member.bound)
        else:
            source.line(f'{name} = {value}.encode() + b"\\0"')
            self._count(f"len({name})", member.path, member.bound, terminators=1)
        self._flush()
        source.line(f"out += {name}")
        self._residue = None

    def _numbers(self, member: Numbers) -> None:
        source = self._source
        name = self._object(member.path)
        if member.length is None:
            self._count(f"len({name})", member.path, member.bound)
        else:
            self._expect_length(member.path, name, member.length)
        self._flush()
        padding = f"out += bytes(({HEADER_BYTES} - len(out)) % {member.size})"
        if member.length is not None and member.size > 1:
            source.line(padding)
        elif member.size > 4:  # after the count it is aligned to 4
            # Before an array without elements there is no padding.
            with source.block(f"if len({name}):"):
                source.line(padding)
        if member.is_octets:
            source.line(f"out += {name}")
        else:
            unpacked = self._unpacked(member, name)
            source.line(f'out += pack(f"<{{len({name})}}{CODES[member.base]}", {unpacked})')
        self._residue = None

    def _elements(self, member: Elements) -> None:
        source = self._source
        elements = self._object(member.path)
        if member.length is None:
            self._count(f"len({elements})", member.path, member.bound)
        else:
            self._expect_length(member.path, elements, member.length)
        self._flush()
        self._residue = None
        element = variable(item_path(member.path))
        # The members' paths begin with the array's own, which here means the element.
        outer = self._objects
        self._objects = {**outer, member.path: element, item_path(member.path): element}
        with source.block(f"for {element} in {elements}:"):
            self._members(member.members)
            self._flush()
        self._objects = outer
        self._residue = None

    def _may_be_none(self, member: Fixed | Numbers) -> bool:
        return self._is_lenient and member.base in FLOATS

    def _unpacked(self, member: Fixed | Numbers, name: str) -> str:
        return f"*map(number, {name})" if self._may_be_none(member) else f"*{name}"

    def _count(self, count: str, path: Path, bound: int | None, terminators: int = 0) -> None:
        """Write the uint32 count of an array or string, which ends a run."""
        if bound is not None:
            with self._source.block(f"if {count} > {bound + terminators}:"):
                expected = f"at most {bound}"
                self._raise_bad_length(
                    path, f"{count} - {terminators}" if terminators else count, expected
                )
        self._slots.append(Slot("I"))
        self._values.append(count)

    def _expect_length(self, path: Path, name: str, length: int) -> None:
        with self._source.block(f"if len({name}) != {length}:"):
            self._raise_bad_length(path, f"len({name})", str(length))

    def _raise_bad_length(self, path: Path, count: str, expected: str) -> None:
        self._source.line(f"raise bad_length({'.'.join(path)!r}, {count}, {expected!r})")

    def _value(self, path: Path) -> str:
        """Return the expression for the value at *path*."""
        known = self._objects.get(path)
        return known or f"{self._object(path[:-1])}.{attribute(path[-1])}"

    def _object(self, path: Path) -> str:
        """Return the variable of the object at *path*; the first call assigns it."""
        if path not in self._objects:
            self._source.line(f"{variable(path)} = {self._value(path)}")
            self._objects[path] = variable(path)
        return self._objects[path]

    def _flush(self) -> None:
        """Write the current run."""
        if not self._slots:
            return
        source = self._source
        run = Run(self._slots, "<")
        if self._residue is not None:
            struct = run.at(self._residue)
            packer = source.constant("PACK", struct.pack, struct.format)
        else:
            structs = run.at_all()
            table = [struct.pack for struct in structs]
            name = source.constant("PACK", table, structs[HEADER_BYTES].format)
            packer = f"{name}[len(out) & 7]"
        packed = f"{packer}({', '.join(self._values)})"
        source.line(f"out += {packed}" if self._is_begun else f"out = bytearray({packed})")
        self._is_begun = True
        self._residue = run.residue_after(self._residue)
        self._slots = []
        self._values = []
