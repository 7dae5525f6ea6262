# SPDX-License-Identifier: Apache-2.0
"""Fields and constants as tables of Markdown, for the reference pages."""

from schemas.definition import Constant, Definition, Field, Value


def members(definition: Definition, page: str = "") -> list[str]:
    """Return the tables of a type's fields and constants. *page* has the nested messages."""
    lines = []
    if definition.fields:
        lines.append("| Field | Type | Default | Description |\n|---|---|---|---|")
        lines += [_field(field, page) for field in definition.fields]
    else:
        lines.append("No fields.")
    if definition.constants:
        lines.append("\n| Constant | Type | Value | Description |\n|---|---|---|---|")
        lines += [_constant(constant) for constant in definition.constants]
    return lines


def anchor(name: str) -> str:
    """Return the anchor of a type on its page."""
    return name.replace("/", "-").lower()


def _field(field: Field, page: str) -> str:
    type_text = str(field.type)
    if not field.type.is_primitive:
        type_text = f"[{type_text}]({page}#{anchor(field.type.base)})".replace("[]]", "\\[\\]]")
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
    cell = " ".join(text.split())
    for character in "\\|<>*_`[]":
        cell = cell.replace(character, f"\\{character}")
    return cell
