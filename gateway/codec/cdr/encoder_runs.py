# SPDX-License-Identifier: Apache-2.0
"""The part of an encoder's source that checks and writes neighbours of fixed size together."""

from dataclasses import dataclass, field

from gateway.codec.cdr.layout import (
    ALIGNMENTS,
    CODES,
    HEADER_BYTES,
    Fixed,
    Numbers,
    Run,
    Slot,
)
from gateway.codec.cdr.source import SourceCode
from schemas.definition import FLOATS


@dataclass(slots=True)
class _Run:
    """Neighbours of fixed size that are not written yet."""

    slots: list[Slot] = field(default_factory=list)
    values: list[str] = field(default_factory=list)
    unchecked: dict[str, list[str]] = field(default_factory=dict)  # variables, by their check


class RunWriter:
    """Writes source by which ``out`` grows, run by run. The first run has the header."""

    def __init__(self, source: SourceCode, *, is_lenient: bool) -> None:
        self._source = source
        self._is_lenient = is_lenient
        self._run = _Run([Slot("s", HEADER_BYTES)], ["CDR_LE"])
        self._residue: int | None = 0  # of the length of out modulo 8, if known
        self._is_begun = False

    def _put_number(self, member: Fixed, name: str) -> None:
        self._run.unchecked.setdefault(_allowed(member.base), []).append(name)
        self._put(Slot(CODES[member.base]), self._as_number(member, name))

    def _put_padding(self, member: Fixed) -> None:
        self._run.slots.append(Slot(CODES[member.base], is_padding=True))

    def _expect_numbers(self, member: Fixed | Numbers, name: str) -> None:
        """Write the check of the elements of an array."""
        allowed = _allowed(member.base)
        with self._source.block(f"if not {allowed}.issuperset(map(type, {name})):"):
            self._source.line(_raise(allowed, name))

    def _put(self, slot: Slot, value: str) -> None:
        self._run.slots.append(slot)
        self._run.values.append(value)

    def _as_number(self, member: Fixed, name: str) -> str:
        if not self._is_lenient or member.base == "bool":
            return name
        return f"NON_FINITE.get({name}, {name})" if member.base in FLOATS else f"whole({name})"

    def _unpacked(self, member: Fixed | Numbers, name: str) -> str:
        if not self._is_lenient or member.base == "bool":
            return f"*{name}"
        if member.base in FLOATS:
            return f"*map(NON_FINITE.get, {name}, {name})"
        return f"*wholes({name})"

    def _flush(self) -> None:
        """Write the current run."""
        if not self._run.slots:
            return
        source = self._source
        for allowed, names in self._run.unchecked.items():
            types = ", ".join(f"type({name})" for name in names)
            with source.block(f"if not {allowed}.issuperset(({types},)):"):
                source.line(_raise(allowed, f"({', '.join(names)},)"))
        run = Run(self._run.slots, "<")
        if self._residue is not None:
            struct = run.at(self._residue)
            packer = source.constant("PACK", struct.pack, struct.format)
        else:
            structs = run.at_all()
            table = [struct.pack for struct in structs]
            name = source.constant("PACK", table, structs[HEADER_BYTES].format)
            packer = f"{name}[len(out) & {ALIGNMENTS - 1}]"
        packed = f"{packer}({', '.join(self._run.values)})"
        source.line(f"out += {packed}" if self._is_begun else f"out = bytearray({packed})")
        self._is_begun = True
        self._residue = run.residue_after(self._residue)
        self._run = _Run()


def _allowed(base: str) -> str:
    """Return the name of the set of Python's types for a primitive."""
    if base in FLOATS:
        return "NUMBERS"
    return "BOOLS" if base == "bool" else "INTEGERS"


def _raise(allowed: str, values: str) -> str:
    return "raise Misfit" if allowed == "BOOLS" else f"raise misfit({values}, LENIENT_{allowed})"
