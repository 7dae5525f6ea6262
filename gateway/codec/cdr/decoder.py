# SPDX-License-Identifier: Apache-2.0
"""CDR to values that `gateway.codec.json.dumps` can write, or to CBOR."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cache
from struct import error as StructError  # noqa: N812
from struct import unpack_from
from typing import Any, Final

import numpy as np
from typing_extensions import assert_never

from gateway.codec.cdr.decoder_runs import RunReader
from gateway.codec.cdr.layout import (
    ALIGNMENTS,
    CODES,
    HEADER_BYTES,
    ByteOrder,
    Cdr,
    Elements,
    Fixed,
    Member,
    Numbers,
    Path,
    Run,
    Selection,
    Slot,
    Text,
    flatten,
    item_path,
    least_size,
    select,
)
from gateway.codec.cdr.rows import each_row, row
from gateway.codec.cdr.sliced_elements import CHUNK_ELEMENTS
from gateway.codec.cdr.source import variable
from gateway.codec.cdr.target import Target, Value
from gateway.codec.cdr.text import wide_text
from gateway.codec.error_text import CodecError
from schemas.definition import Definition, FieldType
from schemas.installed import InstalledDefinitions

_PAUSE: Final = 'yield b""'


def compile_for(
    definition: Definition,
    definitions: InstalledDefinitions,
    fields: Iterable[str] | None,
    target: Target[Value],
    what: str,
    note: str,
) -> Callable[..., Any]:
    """Compile a function for a target. See the functions above."""
    paths = tuple(fields or ())
    selection = select(definition, definitions, paths)
    title = f"{what} of {definition.name}"
    if paths:
        title += f", fields {', '.join(paths)}"
    title += note
    members = flatten(definition, definitions, selection)

    @cache
    def big_endian() -> Callable[..., Any]:
        writer = _DecoderWriter(">", target, definitions)
        return writer.write(definition, members, selection, f"{title}, big-endian", _refuse)

    def other_encapsulation(cdr: Cdr, *rest: object) -> object:
        return big_endian()(cdr, *rest)

    writer = _DecoderWriter("<", target, definitions)
    return writer.write(definition, members, selection, title, other_encapsulation)


def _refuse(cdr: Cdr, *_: object) -> object:
    raise CodecError(
        f"encapsulation 0x{cdr[:2].hex()} is not plain CDR, 0x0000 or 0x0001", offset=0
    )


def _truncated(offset: int, need: int, size: int) -> CodecError:
    return CodecError(f"need {need} bytes at offset {offset}, message has {size}", offset=offset)


def _too_long(path: str, count: int, bound: int, offset: int) -> CodecError:
    return CodecError(f"{path} has {count} elements, at most {bound} are allowed", offset=offset)


class _DecoderWriter(RunReader[Value]):
    """Writes the source of one decoder.

    It uses the variables ``data`` and its ``size``, and ``offset``, the position of the next read.
    ``length`` has the bytes of the run at ``offset``, ``count`` and ``end`` are those of the next
    array or string.
    """

    def __init__(
        self, order: ByteOrder, target: Target[Value], definitions: InstalledDefinitions
    ) -> None:
        super().__init__(order, target)
        self._definitions = definitions

    def write(
        self,
        definition: Definition,
        members: Sequence[Member],
        selection: Selection,
        title: str,
        other_encapsulation: Callable[..., object],
    ) -> Callable[..., Any]:
        source = self._source
        with source.block(f"def decode({self._arguments}):"):
            if self._target.pauses:
                source.line(_PAUSE)
            source.line("size = len(data)")
            source.line("offset = 0")
            with source.block("try:"):
                # The byte order must be known first, but one struct is faster than two.
                self._slots = [Slot("H"), Slot("H", is_padding=True)]
                self._targets = ["encapsulation"]
                self._members(members)
                self._flush()
            with source.block("except StructError:"):
                source.line("raise truncated(offset, length, size) from None")
            message = self._message(definition, (), selection)
            source.line(f"return {self._target.result(message, source)}")
        names = {
            **self._target.names,
            "FLOAT32": np.dtype(f"{self._order}f"),
            "StructError": StructError,
            "other_encapsulation": other_encapsulation,
            "too_long": _too_long,
            "truncated": _truncated,
            "unpack_from": unpack_from,
            "wide_text": wide_text,
        }
        return source.compile("decode", title, names)

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
            self._slots.append(Slot(code, member.length or 1, is_padding=True))
        elif member.base == "float32" and self._target.keeps_float32:
            self._float32(member)
        elif member.length is None:
            self._slots.append(Slot(code))
            self._targets.append(variable(member.path))
        elif member.is_octets:
            name = variable(member.path)
            self._slots.append(Slot("s", member.length))
            self._targets.append(name)
            self._flush()
            if self._target.octets(name) != name:
                self._source.line(f"{name} = {self._target.octets(name)}")
        elif not self._target.takes_tuples:
            self._numbers(Numbers(member.path, member.base, member.length, None, wanted=True))
        else:
            # The tuple that the struct returns is the value.
            self._flush()
            self._slots.append(Slot(code, member.length))
            self._flush(variable(member.path))

    def _text(self, member: Text) -> None:
        source = self._source
        self._count(member.path, member.bound, terminators=0 if member.is_wide else 1)
        source.line("end = offset + count" + (" * 4" if member.is_wide else ""))
        self._check("end - offset", "end")
        if member.wanted and member.is_wide:
            source.line(f"{variable(member.path)} = wide_text(data[offset:end], {self._order!r})")
        elif member.wanted:
            text = 'str(data[offset:end], "utf-8", "replace").partition("\\0")[0]'
            source.line(f"{variable(member.path)} = {text}")
        source.line("offset = end")
        self._residue = None

    def _numbers(self, member: Numbers) -> None:
        source = self._source
        size = member.size
        if member.length is None:
            self._count(member.path, member.bound)
        else:
            self._flush()
            source.line(f"count = {member.length}")
        self._align(size, is_counted=member.length is None)
        source.line("end = offset + count" + (f" * {size}" if size > 1 else ""))
        self._check("end - offset", "end")
        if member.wanted:
            source.line(f"{variable(member.path)} = {self._array(member)}")
        source.line("offset = end")
        if member.length is not None and self._residue is not None:
            self._residue = (self._residue + member.length * size) % ALIGNMENTS
        else:
            self._residue = None

    def _array(self, member: Numbers) -> str:
        if member.is_octets:
            return self._target.octets("memoryview(data)[offset:end]")
        return self._target.numbers(member, self._order, self._source)

    def _elements(self, member: Elements) -> None:
        source = self._source
        if member.length is None:
            self._count(member.path, member.bound)
        else:
            self._flush()
            source.line(f"count = {member.length}")
        run = row(member, self._order)
        is_wanted = any(part.wanted for part in member.members)
        if run is not None and (is_wanted or not member.wanted):
            self._rows(member, run)
            return
        # Each element takes some bytes, so the remaining bytes bound the length of the list.
        need = f"count * {least_size(member.members)}"
        self._check(need, f"offset + {need}")
        name = variable(member.path)
        pauses = self._target.pauses
        if member.wanted:
            source.line(f"{name} = {self._target.elements}")
        self._residue = None
        with source.block("for _ in range(count):"):
            if pauses and not member.wanted:
                source.line(f"if not _ % {CHUNK_ELEMENTS}: {_PAUSE}")
            self._members(member.members)
            self._flush()
            if member.wanted:
                element = self._element(member)
                add = f"if {name}.add({element}): yield from {name}.write()"
                source.line(add if pauses else f"{name}.append({element})")
        if member.wanted and pauses:
            source.line(f"yield from {name}.end()")
        self._residue = None

    def _rows(self, member: Elements, run: Run) -> None:
        """Read elements that consist of numbers and have equal size, in one call."""
        source = self._source
        struct = run.at(HEADER_BYTES)
        self._align(run.alignment, is_counted=member.length is None)
        source.line(f"end = offset + count * {struct.size}")
        self._check("end - offset", "end")
        if member.wanted:
            keep = self._target.keeps_float32
            rows = each_row(member.members, run, self._order, source, keeps_float32=keep)
            each = f"{self._element(member)} {rows}"
            taken = f"yield from {self._target.elements}.take({each})"
            value = taken if self._target.pauses else f"[{each}]"
            source.line(f"{variable(member.path)} = {value}")
        source.line("offset = end")
        self._residue = None

    def _element(self, member: Elements) -> str:
        """Return the expression for one element."""
        if member.definition is None:
            value = self._target.value(FieldType("string"), variable(item_path(member.path)))
        else:
            value = self._message(member.definition, member.path, member.selection)
        return self._target.expression(value, self._source)

    def _count(self, path: Path, bound: int | None, terminators: int = 0) -> None:
        """Read the uint32 count of an array or string, which ends a run."""
        self._slots.append(Slot("I"))
        self._targets.append("count")
        self._flush()
        if bound is not None:
            count = f"count - {terminators}" if terminators else "count"
            with self._source.block(f"if {count} > {bound}:"):
                name = ".".join(path)
                self._source.line(f"raise too_long({name!r}, {count}, {bound}, offset - 4)")

    def _align(self, alignment: int, *, is_counted: bool) -> None:
        """Align the offset for an array of primitives. After a count it is a multiple of 4."""
        if alignment <= (4 if is_counted else 1):
            return
        if is_counted:
            # Before an array without elements there is no padding.
            with self._source.block("if count:"):
                self._source.line("offset = (offset + 3 & -8) + 4")
        elif self._residue is not None:
            padding = (HEADER_BYTES - self._residue) % alignment
            if padding:
                self._source.line(f"offset += {padding}")
                self._residue = (self._residue + padding) % ALIGNMENTS
        else:
            self._source.line(f"offset += ({HEADER_BYTES} - offset) % {alignment}")

    def _check(self, need: str, end: str) -> None:
        with self._source.block(f"if {end} > size:"):
            self._source.line(f"raise truncated(offset, {need}, size)")

    def _message(self, definition: Definition, path: Path, selection: Selection) -> Value:
        """Build a message from its fields, nested messages included."""
        return self._target.message(list(self._entries(definition, path, selection)))

    def _entries(
        self, definition: Definition, path: Path, selection: Selection
    ) -> Iterator[tuple[str, Value]]:
        for field in definition.fields:
            if selection is not None and field.name not in selection:
                continue
            here = (*path, field.name)
            if field.type.is_primitive or field.type.is_array:
                value = self._target.value(field.type, variable(here))
            else:
                nested = self._definitions.get(field.type.base)
                value = self._message(nested, here, selection[field.name] if selection else None)
            yield field.name, value
