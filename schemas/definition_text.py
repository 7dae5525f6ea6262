# SPDX-License-Identifier: Apache-2.0
"""Reading a message definition from a `.msg` text.

The grammar is that of the ROS 2 interface definition
(https://docs.ros.org/en/jazzy/Concepts/Basic/About-Interfaces.html): one field or constant a
line, ``#`` comments, arrays ``T[]``, ``T[N]`` and ``T[<=N]``, bounded strings ``string<=N``.
"""

import re
from collections.abc import Iterator
from typing import Any, Final

from schemas.definition import (
    FLOATS,
    INTEGER_RANGES,
    PRIMITIVES,
    STRINGS,
    Constant,
    Definition,
    DefinitionError,
    Field,
    FieldType,
    Scalar,
    Value,
)

# the encoding of a string type, and the bytes and the name of the units that its bound counts
_UNITS: Final = {
    "string": ("utf-8", 1, "bytes of UTF-8"),
    "wstring": ("utf-16-le", 2, "code units of UTF-16"),
}

_TYPE = re.compile(
    r"(?P<base>[A-Za-z][A-Za-z0-9_]*(?:/[A-Za-z0-9_]+)*)"
    r"(?:<=(?P<string_bound>\d+))?"
    r"(?P<array>\[(?:(?P<at_most><=)?(?P<size>\d+))?\])?"
)
# Letters, digits and single underscores. A character can belong to one part of it only, so the
# time is proportional to the length.
FIELD_NAME: Final = re.compile(r"[a-z][a-z0-9]*(?:_[a-z0-9]+)*_?", re.IGNORECASE | re.ASCII)
CONSTANT_NAME: Final = FIELD_NAME
_STRING_ITEM = re.compile(
    r"""(?P<item>"(?:[^"\\]|\\.)*"|'(?:[^'\\]|\\.)*'|[^"',][^,]*)\s*(?:,\s*|$)"""
)
# Names of ROS 1 that the ROS 2 generators still accept.
_ALIASES: Final = {
    "char": "uint8",
    "time": "builtin_interfaces/msg/Time",
    "duration": "builtin_interfaces/msg/Duration",
}


def parse_definition(
    name: str, text: str, type_hash: str | None = None, *, first_line: int = 1
) -> Definition:
    """Parse the text of one message: a `.msg` file, or one part of a `.srv` or an `.action`.

    *first_line* is the number of its first line in the file.

    Raises:
        DefinitionError: a line is neither a comment, a field nor a constant, or one has the name of
            another.
    """
    fields: dict[str, Field] = {}
    constants: dict[str, Constant] = {}
    message_comment: list[str] | None = None
    for line_number, above, declaration, beside in _declarations(text, first_line):
        if message_comment is None:
            # The first block of comments describes the message, unless it touches a field.
            *blocks, own = above
            message_comment = [line for block in blocks for line in [*block, ""]]
        else:
            own = above[-1]
        if not declaration:
            if not fields and not constants:
                message_comment += own
            continue
        comment = "\n".join([*own, beside] if beside else own).strip()
        try:
            member = _parse_member(name.split("/")[0], declaration, comment)
        except ValueError as error:
            raise DefinitionError(f"{name}, line {line_number}: {error}") from error
        members: dict[str, Any] = fields if isinstance(member, Field) else constants
        if member.name in members:
            problem = f"the second member {member.name}; rename it"
            raise DefinitionError(f"{name}, line {line_number}: {problem}")
        members[member.name] = member
    comment = "\n".join(message_comment or []).strip()
    all_fields, all_constants = tuple(fields.values()), tuple(constants.values())
    return Definition(name, all_fields, all_constants, comment, text, type_hash)


def _declarations(text: str, first_line: int) -> Iterator[tuple[int, list[list[str]], str, str]]:
    """Yield line number, blocks of comments above, declaration, comment next to it.

    A comment next to a declaration continues in the indented comment lines right below it. The
    last item is an empty declaration with the comments after the last one.
    """
    blocks: list[list[str]] = [[]]
    declared: tuple[int, list[list[str]], str, str] | None = None
    number = 0
    for number, line in enumerate(text.splitlines(), start=first_line):
        stripped = line.strip()
        if declared is not None:
            if declared[3] and line[:1].isspace() and stripped.startswith("#"):
                declared = (*declared[:3], f"{declared[3]}\n{_uncommented(stripped)}")
                continue
            yield declared
            declared = None
        if not stripped:
            if blocks[-1]:
                blocks.append([])
        elif stripped.startswith("#"):
            blocks[-1].append(_uncommented(stripped))
        else:
            declaration, beside = _split_comment(stripped)
            declared = (number, blocks, declaration, beside)
            blocks = [[]]
    if declared is not None:
        yield declared
    yield number, blocks, "", ""


def _uncommented(comment: str) -> str:
    return comment.lstrip("#").removeprefix(" ").rstrip()


def _split_comment(line: str) -> tuple[str, str]:
    """Split a declaration from the comment behind it. A ``#`` in quotes begins no comment."""
    quote = ""
    escaped = False
    for index, character in enumerate(line):
        if escaped:
            escaped = False
        elif character == "\\":
            escaped = True
        elif quote:
            quote = "" if character == quote else quote
        elif character in "\"'":
            quote = character
        elif character == "#":
            return line[:index].rstrip(), _uncommented(line[index:])
    return line, ""


def _parse_member(package: str, declaration: str, comment: str) -> Field | Constant:
    # rosidl reads a tab as a space, even inside quotes
    type_text, _, rest = declaration.replace("\t", " ").partition(" ")
    field_type = parse_field_type(type_text, package)
    rest = rest.strip()
    constant, equals, value = rest.partition("=")
    # "string<=3 x" has its "=" inside the type, and a default may hold one inside quotes
    if equals and CONSTANT_NAME.fullmatch(constant.strip()):
        parsed = _parse_value(field_type, value.strip())
        if isinstance(parsed, tuple):
            raise ValueError(f"constant {constant.strip()} is an array")
        return Constant(constant.strip(), field_type.base, parsed, comment)
    field, _, default = rest.partition(" ")
    if not FIELD_NAME.fullmatch(field):
        raise ValueError(f"{field!r} is no field name")
    default = default.strip()
    value_or_none = _parse_value(field_type, default) if default else None
    _check_sizes(field_type, value_or_none)
    return Field(field, field_type, value_or_none, comment)


def parse_field_type(text: str, package: str) -> FieldType:
    """Parse a type such as ``float64[<=3]`` as written in a definition of *package*.

    Raises:
        ValueError: the text is not a type.
    """
    match = _TYPE.fullmatch(text)
    if match is None:
        raise ValueError(f"{text!r} is not a valid type")
    base = _ALIASES.get(match["base"], match["base"])
    if base not in PRIMITIVES:
        base = _qualified(base, package)
    elif match["string_bound"] and base not in STRINGS:
        raise ValueError(f"{base} takes no length")
    size = int(match["size"]) if match["size"] else None
    string_bound = int(match["string_bound"]) if match["string_bound"] else None
    if 0 in {size, string_bound}:
        raise ValueError(f"{text}: a length is at least 1")
    is_sequence = match["array"] is not None and (size is None or match["at_most"] is not None)
    return FieldType(
        base,
        is_sequence,
        length=None if is_sequence else size,
        bound=size if is_sequence else None,
        string_bound=string_bound,
    )


def _qualified(name: str, package: str) -> str:
    match name.split("/"):
        case [short]:
            return f"{package}/msg/{short}"
        case [other, short]:
            return f"{other}/msg/{short}"
        case [_, _, _]:
            return name
    raise ValueError(f"{name!r} is not a valid type name")


def _parse_value(field_type: FieldType, text: str) -> Value:
    """Read a default or a constant in the notation of `.msg` files."""
    if not field_type.is_primitive:
        raise ValueError(f"a {field_type.base} has no literal")
    if not field_type.is_array:
        return _parse_scalar(field_type.base, text)
    if not (text.startswith("[") and text.endswith("]")):
        raise ValueError(f"{text!r} is no array")
    if field_type.base in STRINGS:
        return _parse_strings(text[1:-1].strip())
    items = [item.strip() for item in text[1:-1].split(",")]
    return tuple(_parse_scalar(field_type.base, item) for item in items if item)


def text_misfit(text: str, kind: FieldType) -> str | None:
    """Return the reason why a text is not a value of a string type, ``None`` if it is one."""
    if "\0" in text:
        return "a string cannot hold U+0000"
    encoding, unit, units = _UNITS[kind.base]
    try:
        size = len(text.encode(encoding)) // unit
    except UnicodeEncodeError:
        return "a string cannot hold a lone surrogate"
    if kind.string_bound is not None and size > kind.string_bound:
        return f"text has {size} {units}, at most {kind.string_bound} fit"
    return None


def _check_sizes(field_type: FieldType, default: Value | None) -> None:
    """Refuse a default of which no message can be made, as rosidl does."""
    values = default if isinstance(default, tuple) else (default,)
    count = len(values)
    if isinstance(default, tuple):
        if field_type.length is not None and count != field_type.length:
            raise ValueError(f"the default has {count} values, expected {field_type.length}")
        if field_type.bound is not None and count > field_type.bound:
            raise ValueError(f"the default has {count} values, at most {field_type.bound}")
    for value in values:
        misfit = text_misfit(value, field_type) if isinstance(value, str) else None
        if misfit:
            raise ValueError(f"the default cannot be: {misfit}")


def _parse_strings(text: str) -> tuple[str, ...]:
    """Split strings at their commas. As in rosidl, those without a comma need no quotes."""
    values: list[str] = []
    end = 0
    while end < len(text):
        match = _STRING_ITEM.match(text, end)
        if match is None:
            raise ValueError(f"{text[end:]!r} is no array of strings")
        values.append(_unquoted(match["item"].strip()))
        end = match.end()
    return tuple(values)


def _unquoted(text: str) -> str:
    if len(text) >= 2 and text[0] == text[-1] and text[0] in "\"'":
        return text[1:-1].replace(f"\\{text[0]}", text[0])
    return text


def _parse_scalar(base: str, text: str) -> Scalar:
    if base == "bool":
        if text.lower() in {"true", "1"}:
            return True
        if text.lower() in {"false", "0"}:
            return False
        raise ValueError(f"{text!r} is no bool")
    if base in FLOATS:
        return float(text)
    if base in STRINGS:
        return _unquoted(text)
    value = _parse_integer(text)
    low, high = INTEGER_RANGES[base]
    if not low <= value <= high:
        raise ValueError(f"{value} is not of type {base}")
    return value


def _parse_integer(text: str) -> int:
    try:
        return int(text)  # as in rosidl, decimal comes first, so 010 is 10
    except ValueError:
        return int(text, 0)
