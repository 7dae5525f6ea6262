# SPDX-License-Identifier: Apache-2.0
"""A search for the costliest frames: arrays of messages.

It tries every array of every message type, with empty elements and with elements of one field each.
"""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final

from benchmarks.hostile_frames import MAX_MESSAGE_BYTES, SPARE, HostileFrame, publish
from gateway.codec.cdr.layout import flatten
from gateway.codec.cdr.misfits import MAX_FIELDS, count_fields
from gateway.codec.json_bounds import MAX_CONTAINERS, MAX_ITEMS
from schemas.definition import FLOATS, INTEGER_RANGES, STRINGS, Definition, FieldType
from schemas.installed import InstalledDefinitions

_MAX_NESTING: Final = 3  # arrays of messages within arrays of messages
_SPARE_FIELDS: Final = 1000  # of the messages around an array within arrays


@dataclass(frozen=True)
class Bomb:
    """An array of messages somewhere in a type, to be filled with one element many times."""

    type_name: str
    template: str
    """The message as JSON, with ``@`` for the elements."""
    element: str
    fields: int
    """For which one element counts."""

    def frame(self, count: int) -> HostileFrame:
        """Return a frame with so many elements."""
        elements = ",".join([self.element] * count)
        short = self.template.replace("@", f"{self.element},... {count}")
        return HostileFrame(
            f"{self.type_name.rpartition('/')[2]} {short}",
            publish(self.type_name, self.template.replace("@", elements)),
        )

    def counts(self) -> set[int]:
        """Return the most elements that are encoded, and the most that are looked at."""
        containers = self.element.count("{") + self.element.count("[")
        items = containers + self.element.count(",") + 1
        most = min(
            (MAX_CONTAINERS - SPARE) // containers,
            (MAX_ITEMS - SPARE) // items,
            (MAX_MESSAGE_BYTES - 1000) // (len(self.element) + 1),
        )
        return {most, max(1, min(most, (MAX_FIELDS - _SPARE_FIELDS) // self.fields))}


def bombs(definitions: InstalledDefinitions) -> Iterator[Bomb]:
    """Return the arrays of messages in all installed types, each with several fillings."""
    for name in definitions.names():
        for template, definition in _arrays(definitions.get(name), definitions, _MAX_NESTING):
            fields = count_fields(flatten(definition, definitions))
            yield Bomb(name, template, "{}", 1)
            for field in definition.fields:
                value = json.dumps(_smallest(field.type))
                yield Bomb(name, template, f'{{"{field.name}":{value}}}', fields)


def _arrays(
    definition: Definition, definitions: InstalledDefinitions, nesting: int
) -> Iterator[tuple[str, Definition]]:
    """Return templates of the message with one array open, and the type of its elements."""
    for field in definition.fields:
        if field.type.is_primitive:
            continue
        inner = definitions.get(field.type.base)
        if field.type.is_sequence and field.type.bound is None:
            yield f'{{"{field.name}":[@]}}', inner
            if nesting > 1:
                for template, element in _arrays(inner, definitions, nesting - 1):
                    yield f'{{"{field.name}":[{template}]}}', element
        elif not field.type.is_array:
            for template, element in _arrays(inner, definitions, nesting):
                yield f'{{"{field.name}":{template}}}', element


def _smallest(kind: FieldType) -> Any:
    """Return the shortest value of a field."""
    if kind.length is not None and not kind.is_octets:
        return [_smallest(FieldType(kind.base))] * kind.length
    if kind.length is not None:
        return [0] * kind.length
    if kind.is_array:
        return []
    if kind.base in STRINGS:
        return ""
    if kind.base in FLOATS or kind.base in INTEGER_RANGES:
        return 0
    return False if kind.base == "bool" else {}
