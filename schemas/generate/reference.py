# SPDX-License-Identifier: Apache-2.0
"""Write the reference page of messages: the table, and every type with fields and constants."""

from typing import Final

from schemas.definition import Definition
from schemas.generate.catalogue import GENERATED, Catalogue, by_package
from schemas.generate.markdown import anchor, members
from schemas.table import Row

_INTRODUCTION: Final = f"""\
<!-- {GENERATED} -->
# Messages

Look up a message type here: its number, its JSON, its fields, and its constants.

Clients name a type as `pkg/msg/Name`, as `pkg/Name`, or by its number. Numbers never change.
Types that are not in this list also work. [Use your own messages](../how-to/own-messages.md)
explains how.

## Values in JSON
"""

_CARRIED: Final = {
    "`bool`": "`true` or `false`",
    "`int8` ... `uint64`, `byte`, `char`": "a number without fraction, in the range of its type",
    "`float32`, `float64`": ("a number; `null` for NaN, and for infinities that the gateway sends"),
    "`string`, `wstring`": (
        "text without NUL; `N` counts bytes in `string<=N`, UTF-16 units in `wstring<=N`"
    ),
    "`uint8[]`, `byte[]`, `char[]`, also `[N]`, `[<=N]`": (
        "base64; clients can also send an array of integers"
    ),
    "other arrays": "an array: `[N]` has exactly `N` elements, `[<=N]` at most",
    "`builtin_interfaces/msg/Time`": (
        '`{"sec": 1, "nanosec": 5}`; clients can also send `{"secs": 1, "nsecs": 5}` or `"now"`'
    ),
    "`builtin_interfaces/msg/Duration`": 'as for `Time`, without `"now"`',
    "`std_msgs/msg/Header`": (
        "an object; without `stamp` it gets the time of arrival; `seq` is ignored"
    ),
}

_OMITTED: Final = """\
If a client leaves out a field, it gets its default. Unknown fields and values out of range are
refused.
"""


def write(catalogue: Catalogue) -> dict[str, str]:
    """Return the page."""
    rows = {row.name: row for row in catalogue.rows}
    parts = [_INTRODUCTION, "| ROS 2 | JSON |\n|---|---|"]
    parts += [f"| {ros} | {carried} |" for ros, carried in _CARRIED.items()]
    parts += ["", _OMITTED, "## List of message types\n"]
    parts.append("| Number | Type | Directions | Purpose |\n|---|---|---|---|")
    parts += [
        f"| {row.number} | [{row.name}](#{anchor(row.name)}) | {row.directions} | {row.purpose} |"
        for row in catalogue.rows
    ]
    for package, definitions in by_package(catalogue.definitions.values()).items():
        parts.append(f"\n## {package}")
        for definition in sorted(definitions, key=lambda one: one.name):
            parts.append(_section(definition, rows.get(definition.name)))
    return {"docs/reference/messages.md": "\n".join(parts) + "\n"}


def _section(definition: Definition, row: Row | None) -> str:
    lines = [f'\n### <a id="{anchor(definition.name)}"></a>{definition.name}\n']
    if row is not None:
        lines.append(f"Number {row.number}. {row.purpose}.\n")
    return "\n".join([*lines, *members(definition)])
