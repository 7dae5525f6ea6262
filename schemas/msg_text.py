# SPDX-License-Identifier: Apache-2.0
"""The text of a definition in the notation of `.msg` files, which is what clients read."""

import re
from typing import Final

from schemas.definition import Definition, Scalar, Value

# as rosidl reads them in the strings of a .msg file. All that could end a line is among them
_ESCAPED: Final = re.compile(r'[\\"\x00-\x1f\x7f-\x9f\u2028\u2029]')


def msg_text(definition: Definition) -> str:
    """Return the text of a `.msg` file with this message, which reads as the same definition.

    Only strings with backslashes or control characters are written as escapes.
    """
    lines = _commented(definition.comment)
    members = [
        *((f"{c.type} {c.name}={_literal(c.value)}", c.comment) for c in definition.constants),
        *(
            (
                f"{f.type} {f.name}{'' if f.default is None else f' {_literal(f.default)}'}",
                f.comment,
            )
            for f in definition.fields
        ),
    ]
    is_close = not lines
    for declaration, comment in members:
        above = _commented(comment)
        # a blank line keeps the comment of a member from the one of the message
        if lines and (above or not is_close):
            lines.append("")
        lines += [*above, declaration]
        is_close = True
    return "".join(f"{line}\n" for line in lines)


def _commented(comment: str) -> list[str]:
    return [f"# {line}".rstrip() for line in comment.splitlines()]


def _literal(value: Value) -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(_scalar(each) for each in value)}]"
    return _scalar(value)


def _scalar(value: Scalar) -> str:
    match value:
        case bool():
            return "true" if value else "false"
        case str():
            return f'"{_ESCAPED.sub(_escape, value)}"'
    return repr(value)


def _escape(match: re.Match[str]) -> str:
    character = match[0]
    if character in '\\"':
        return f"\\{character}"
    return f"\\x{ord(character):02x}" if ord(character) < 256 else f"\\u{ord(character):04x}"
