# SPDX-License-Identifier: Apache-2.0
"""Arrays of messages that consist of numbers, read as a table: a row for each element."""

from collections.abc import Sequence
from dataclasses import replace
from struct import calcsize
from typing import Final

from gateway.codec.cdr.layout import (
    CODES,
    HEADER_BYTES,
    ByteOrder,
    Elements,
    Fixed,
    Member,
    Run,
    Slot,
)
from gateway.codec.cdr.source import SourceCode, variable

_FLOAT32_BYTES: Final = 4


def row(member: Elements, order: ByteOrder) -> Run | None:
    """Return the run of one element, if elements follow each other without padding."""
    slots = []
    for part in member.members:
        if not isinstance(part, Fixed) or (part.wanted and part.length is not None):
            return None
        slots.append(Slot(CODES[part.base], part.length or 1, is_padding=not part.wanted))
    run = Run(slots, order)
    first = calcsize(f"<{slots[0].code}")
    is_even = run.alignment == first and run.at(HEADER_BYTES).size % first == 0
    return run if is_even else None


def each_row(
    members: Sequence[Member],
    run: Run,
    order: ByteOrder,
    source: SourceCode,
    *,
    keeps_float32: bool,
) -> str:
    """Return the source ``for NAMES in ROWS`` over the elements from ``offset`` to ``end``.

    With *keeps_float32* floats of this type are columns of one numpy view: to make each from a
    Python float takes seven times as long.
    """
    numbers: list[str] = []
    floats: dict[str, int] = {}  # the column of each
    slots: list[Slot] = []
    for member, slot, start in zip(members, run.slots, run.starts(HEADER_BYTES), strict=True):
        is_column = keeps_float32 and slot.code == "f" and not slot.is_padding
        if is_column:
            floats[variable(member.path)] = start // _FLOAT32_BYTES
        elif not slot.is_padding:
            numbers.append(variable(member.path))
        slots.append(replace(slot, is_padding=slot.is_padding or is_column))
    struct = Run(slots, order).at(HEADER_BYTES)
    unpack = source.constant("ROWS", struct.iter_unpack, struct.format) if numbers else ""
    rows = f"{unpack}(memoryview(data)[offset:end])"
    in_row = "".join(f"{name}, " for name in numbers).strip()
    if not floats:
        return f"for {in_row} in {rows}"
    stride = struct.size // _FLOAT32_BYTES
    source.line(f"floats = frombuffer(data, FLOAT32, count * {stride}, offset)")
    columns = [f"floats[{start}::{stride}].flat" for start in floats.values()]
    targets = list(floats)
    if numbers:
        columns.append(rows)
        targets.append(f"({in_row})")
    return f"for {', '.join(targets)}, in zip({', '.join(columns)})"
