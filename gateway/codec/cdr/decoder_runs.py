# SPDX-License-Identifier: Apache-2.0
"""The part of a decoder's source that reads neighbours of fixed size together."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final, Generic

from gateway.codec.cdr.layout import HEADER_BYTES, ByteOrder, Fixed, Run, Slot
from gateway.codec.cdr.source import SourceCode, variable
from gateway.codec.cdr.target import NATIVE, Target, Value

# RTPS 2.5, 10.2: CDR_LE is the octets {0x00, 0x01}, CDR_BE {0x00, 0x00}, each in its own order.
_ENCAPSULATIONS: Final = {"<": 0x0100, ">": 0x0000}


class RunReader(Generic[Value]):
    """Writes source by which ``offset`` grows, run by run."""

    def __init__(self, order: ByteOrder, target: Target[Value]) -> None:
        self._order: ByteOrder = order
        self._target = target
        self._arguments = ", ".join(("data", *target.arguments))
        self._source = SourceCode()
        self._slots: list[Slot] = []
        self._targets: list[str] = []
        # the float32 of the run: the variable of their bytes, and those of each (none for an array)
        self._floats: list[tuple[str, list[str]]] = []
        self._residue: int | None = 0  # of the offset modulo 8, if known

    def _float32(self, member: Fixed) -> None:
        """Read them as one array of numpy, neighbours together: one each takes twice as long."""
        name, length = variable(member.path), member.length
        if length is None and self._floats and self._slots[-1].is_raw and self._floats[-1][1]:
            self._slots[-1] = replace(self._slots[-1], count=self._slots[-1].count + 1)
            self._floats[-1][1].append(name)
            return
        self._slots.append(Slot("f", length or 1, is_raw=True))
        self._targets.append(name)
        self._floats.append((name, [name] if length is None else []))

    def _floats_of(self, octets: str, names: Sequence[str]) -> str:
        """Return the assignment of float32 whose bytes have been read."""
        view = f"frombuffer({octets}, FLOAT32)"
        if len(names) == 1:
            return f"{names[0]} = {view}[0]"
        if names:  # an array's own iterator ends by an IndexError, and so takes twice as long
            return f"{', '.join(names)} = {view}.flat"
        # orjson writes arrays in native order only
        return f"{octets} = {view}" + ("" if self._order == NATIVE else '.astype("=f")')

    def _flush(self, target: str | None = None) -> None:
        """Read the current run, into its variables or as a whole into *target*."""
        if not self._slots:
            return
        source = self._source
        run = Run(self._slots, self._order)
        if self._residue is not None:
            struct = run.at(self._residue)
            source.line(f"length = {struct.size}")
            unpack = source.constant("UNPACK", struct.unpack_from, struct.format)
        else:
            structs = run.at_all()
            table = [(struct.unpack_from, struct.size) for struct in structs]
            name = source.constant("UNPACK", table, structs[HEADER_BYTES].format)
            source.line(f"unpack, length = {name}[offset & 7]")
            unpack = "unpack"
        targets = target or "".join(f"{name}, " for name in self._targets)
        source.line(f"{targets.strip()} = {unpack}(data, offset)".removeprefix(" = "))
        source.line("offset += length")
        if "encapsulation" in self._targets:
            with source.block(f"if encapsulation != {_ENCAPSULATIONS[self._order]}:"):
                pause = "yield from " if self._target.pauses else ""
                source.line(f"return ({pause}other_encapsulation({self._arguments}))")
        for octets, names in self._floats:
            source.line(self._floats_of(octets, names))
        self._residue = run.residue_after(self._residue)
        self._slots = []
        self._targets = []
        self._floats = []
