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

Clients name a type as `pkg/msg/Name`, as `pkg/Name`, or by its number below. Numbers never
change. Types outside this table work too, if their packages or their definitions are installed on
the machine of the gateway. [Your own messages](../how-to/own-messages.md) says how, and how to give
one a number.

## What JSON carries
"""

_CARRIED: Final = {
    "`bool`": "`true` or `false`",
    "`int8` ... `uint64`, `byte`, `char`": "a number without fraction, in the range of its type",
    "`float32`, `float64`": (
        "a number, or `null` for NaN; infinities go out as `null` too; a `float32` beyond its "
        "range is refused"
    ),
    "`string`, `wstring`": (
        "text without NUL; `string<=N` counts bytes of UTF-8, `wstring<=N` code units of UTF-16"
    ),
    "`uint8[]`, `byte[]`, `char[]`, also `[N]`, `[<=N]`": (
        "base64; an array of integers is taken too"
    ),
    "other arrays": "an array, `[N]` of exactly, `[<=N]` of at most that length",
    "`builtin_interfaces/msg/Time`": (
        '`{"sec": 1, "nanosec": 5}`, `nanosec` as it is, also from 10^9 on; also taken: '
        '`{"secs": 1, "nsecs": 5}` and `"now"`'
    ),
    "`builtin_interfaces/msg/Duration`": 'like Time, without `"now"`',
    "`std_msgs/msg/Header`": (
        "an object; one without `stamp` is stamped on arrival, `seq` is ignored"
    ),
}

_OMITTED: Final = """\
A field that a client leaves out gets its default; one that the type does not have is refused.
"""


def write(catalogue: Catalogue) -> dict[str, str]:
    """Return the page."""
    rows = {row.name: row for row in catalogue.rows}
    parts = [_INTRODUCTION, "| ROS 2 | JSON |\n|---|---|"]
    parts += [f"| {ros} | {carried} |" for ros, carried in _CARRIED.items()]
    parts += ["", _OMITTED, "## The table\n"]
    parts.append("| no. | type | directions | purpose |\n|---|---|---|---|")
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
