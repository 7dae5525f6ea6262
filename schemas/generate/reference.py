# SPDX-License-Identifier: Apache-2.0
"""Write the reference page: the table, and every type with its fields and constants."""

from typing import Final

from schemas.definition import Constant, Definition, Field, Value
from schemas.generate.catalogue import GENERATED, Catalogue
from schemas.table import Row

_INTRODUCTION: Final = f"""\
<!-- {GENERATED} -->
# Messages

Clients name a type as `pkg/msg/Name`, as `pkg/Name`, or by its number below. Numbers never
change. Types outside this table work too, as far as their packages are installed where the
gateway runs; [adding a type](adding-a-type.md) gives one a number.

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
        '`{"sec": 1, "nanosec": 5}`, `nanosec` below 10^9; also taken: `{"secs": 1, "nsecs": 5}` '
        'and `"now"`'
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
        f"| {row.number} | [{row.name}](#{_anchor(row.name)}) | {row.directions} | {row.purpose} |"
        for row in catalogue.rows
    ]
    for package, definitions in catalogue.packages().items():
        parts.append(f"\n## {package}")
        for definition in sorted(definitions, key=lambda one: one.name):
            parts.append(_section(definition, rows.get(definition.name)))
    return {"docs/messages.md": "\n".join(parts) + "\n"}


def _section(definition: Definition, row: Row | None) -> str:
    lines = [f'\n### <a id="{_anchor(definition.name)}"></a>{definition.name}\n']
    if row is not None:
        lines.append(f"Number {row.number}. {row.purpose}.\n")
    if definition.fields:
        lines.append("| field | type | default | |\n|---|---|---|---|")
        lines += [_field(field) for field in definition.fields]
    else:
        lines.append("No fields.")
    if definition.constants:
        lines.append("\n| constant | type | value | |\n|---|---|---|---|")
        lines += [_constant(constant) for constant in definition.constants]
    return "\n".join(lines)


def _field(field: Field) -> str:
    type_text = str(field.type)
    if not field.type.is_primitive:
        type_text = f"[{type_text}](#{_anchor(field.type.base)})".replace("[]]", "\\[\\]]")
    default = "" if field.default is None else f"`{_value(field.default)}`"
    return f"| {field.name} | {type_text} | {default} | {_cell(field.comment)} |"


def _constant(constant: Constant) -> str:
    value = _value(constant.value)
    return f"| {constant.name} | {constant.type} | `{value}` | {_cell(constant.comment)} |"


def _value(value: Value) -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(_value(one) for one in value)}]"
    return str(value).lower() if isinstance(value, bool) else str(value)


def _cell(text: str) -> str:
    """Return a comment as one cell of a table."""
    words = " ".join(text.split())
    for character in "\\|<>*_`[]":
        words = words.replace(character, f"\\{character}")
    return words


def _anchor(name: str) -> str:
    return name.replace("/", "-").lower()
