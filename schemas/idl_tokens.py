# SPDX-License-Identifier: Apache-2.0
"""The words of OMG IDL 4.2, as far as rosidl reads it: names, numbers, strings, symbols.

Each character is looked at a bounded number of times, and the text is bounded.
"""

import codecs
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, Literal

from schemas.definition import DefinitionError, Scalar

# Fifteen times the longest definition in ROS. Reading as much takes 0.3 s where each is a word.
MAX_CHARACTERS: Final = 128 * 1024
_MAX_ECHO: Final = 40  # of a word in an error text

TokenKind = Literal["name", "number", "string", "symbol", "include", "end"]

_TOKEN: Final = re.compile(
    r"""
    (?P<skipped> \s+ | //[^\n]* )
  | (?P<comment> /\* )
  | (?P<include> \# [ \t]* include [ \t]* (?: <[^>\n]+> | "[^"\n]+" ) )
  | (?P<string> L?"(?: [^"\\\n] | \\. )*" )
  | (?P<number> \.?\d (?: [eE][+-] | [\w.] )* )
  | (?P<name> [A-Za-z]\w* )
  | (?P<symbol> :: | [][{}()<>,;:=@+\-*/%|&^~] )
    """,
    re.ASCII | re.VERBOSE,
)
# an integer (hexadecimal, octal, decimal), and a float or a fixed-point number with its d
_INTEGER: Final = re.compile(r"0[xX](?P<hexadecimal>[0-9a-fA-F]+)|0(?P<octal>[0-7]+)|0|[1-9]\d*")
_FLOAT: Final = re.compile(r"(?P<value>(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?)[dD]?", re.ASCII)
# Table 7-9 of the standard, except \?, of which rosidl keeps both characters
_ESCAPE: Final = re.compile(r"""\\(?:[ntvbrfa\\'"]|[0-3][0-7]{2}|[0-7]{1,2}|x[0-9a-fA-F]{1,2})""")
_WIDE_ESCAPE: Final = re.compile(rf"{_ESCAPE.pattern}|\\u[0-9a-fA-F]{{1,4}}")
_ESCAPED_TWICE: Final = re.compile(r"""\\(["\\])""")


class PlaceError(ValueError):
    """Something is wrong at an offset of a text. Turned into a `DefinitionError` with the place."""

    def __init__(self, offset: int, reason: str) -> None:
        super().__init__(reason)
        self.offset = offset


@dataclass(frozen=True, slots=True)
class IdlToken:
    """One word of the text, and where it begins."""

    kind: TokenKind
    text: str
    offset: int

    def __str__(self) -> str:
        """Return the word as error texts show it."""
        return "the end of the file" if self.kind == "end" else shortened(self.text)


def shortened(text: str) -> str:
    """Return as much of the text as an error text shows."""
    return text if len(text) <= _MAX_ECHO else f"{text[:_MAX_ECHO]}..."


def tokens(text: str) -> Iterator[IdlToken]:
    """Yield the words of a text without comments, and an ``end`` behind them.

    Raises:
        PlaceError: a character begins no word, or the text is too long.
    """
    if len(text) > MAX_CHARACTERS:
        raise PlaceError(
            MAX_CHARACTERS, f"at most {MAX_CHARACTERS} characters are read, this file has more"
        )
    offset = 0
    while offset < len(text):
        match = _TOKEN.match(text, offset)
        if match is None:
            raise PlaceError(offset, _unreadable(text[offset]))
        begin, offset = offset, match.end()
        if match.lastgroup == "comment":
            end = text.find("*/", offset)
            if end < 0:
                raise PlaceError(begin, "expected */ behind the /* here; close the comment")
            offset = end + 2
        elif match.lastgroup != "skipped":
            kind: TokenKind = match.lastgroup  # type: ignore[assignment]  # a group of the pattern
            yield IdlToken(kind, match[0], begin)
    yield IdlToken("end", "", len(text))


def _unreadable(character: str) -> str:
    match character:
        case '"':
            return 'expected a " at the end of this string; close it on the same line'
        case "#":
            return 'expected #include "PACKAGE/msg/NAME.idl", the only directive that rosidl reads'
        case "'":
            return "rosidl reads no literals of characters; write a number"
        case "_":
            return "expected a letter at the start of a name, as rosidl does; leave out the _"
    return f"expected IDL, got {character!r}; remove it"


def number(token: IdlToken) -> int | float:
    """Return the value of a ``number``.

    Raises:
        PlaceError: it has a suffix, or is too long.
    """
    integer = _INTEGER.fullmatch(token.text)
    floating = _FLOAT.fullmatch(token.text)
    try:
        if integer is not None and integer["hexadecimal"]:
            return int(integer["hexadecimal"], 16)
        if integer is not None and integer["octal"]:
            return int(integer["octal"], 8)
        if integer is not None:
            return int(token.text)
        if floating is not None and not token.text.isdigit():  # no octal such as 08
            return float(floating["value"])
    except ValueError:  # more than 4300 digits
        pass
    raise PlaceError(token.offset, f"expected a number such as 12, 0x1f or 1.5e3, got {token}")


def string(token: IdlToken) -> str:
    """Return the text that a ``string`` stands for, as rosidl reads it.

    Raises:
        PlaceError: it has what no string of ROS can hold.
    """
    is_wide = token.text.startswith("L")
    text = token.text[2:-1] if is_wide else token.text[1:-1]
    try:
        text = (_WIDE_ESCAPE if is_wide else _ESCAPE).sub(_unescaped, text)
    except ValueError as error:
        raise PlaceError(
            token.offset, f"expected escapes such as \\n or \\x41 in {token}"
        ) from error
    # rosidl reads these escapes a second time
    return checked(token, _ESCAPED_TWICE.sub(r"\1", text))


def checked(token: IdlToken, text: str) -> str:
    """Return *text* with its surrogates joined.

    Raises:
        PlaceError: it has what no string of ROS can hold.
    """
    try:
        return text.encode("utf-16-le", "surrogatepass").decode("utf-16-le")
    except UnicodeDecodeError:
        raise PlaceError(token.offset, "a string cannot hold a lone surrogate") from None


def _unescaped(match: re.Match[str]) -> str:
    return codecs.decode(match[0], "unicode-escape")


# Python's notation of several values, in which rosidl writes the default of an array
_ITEM: Final = re.compile(
    r"""\s*(?:(?P<text>'(?:[^'\\]|\\.)*'|"(?:[^"\\]|\\.)*")|(?P<plain>[^\s,'"()]+))\s*(?:,|\Z)"""
)
_PYTHON_ESCAPE: Final = re.compile(
    r"""\\(?:[ntvbrfa\\'"]|[0-3][0-7]{2}|[0-7]{1,2}|x[0-9a-fA-F]{2}|u[0-9a-fA-F]{4}|U[0-9a-fA-F]{8})"""
)
_WORDS: Final = {"True": True, "False": False}


def items(token: IdlToken, text: str) -> tuple[Scalar, ...]:
    """Return the values in a default of an array, such as ``"(1, 2)"``.

    Raises:
        PlaceError: the text is not such a default.
    """
    stripped = text.strip()
    expected = PlaceError(token.offset, f'expected a default such as "(1, 2, 3)", got {token}')
    if not (stripped.startswith("(") and stripped.endswith(")")):
        raise expected
    inner = stripped[1:-1].strip()
    values: list[Scalar] = []
    end = 0
    while end < len(inner):
        match = _ITEM.match(inner, end)
        if match is None:
            raise expected
        try:
            values.append(_item(match))
        except ValueError:
            raise expected from None
        end = match.end()
    return tuple(checked(token, each) if isinstance(each, str) else each for each in values)


def _item(match: re.Match[str]) -> Scalar:
    if match["text"] is not None:
        return _PYTHON_ESCAPE.sub(_unescaped, match["text"][1:-1])
    plain = match["plain"]
    if plain in _WORDS:
        return _WORDS[plain]
    try:
        return int(plain)
    except ValueError:
        return float(plain)


def with_place(name: str, text: str, error: PlaceError) -> DefinitionError:
    """Return the error with the file, line and column of its offset."""
    line = text.count("\n", 0, error.offset) + 1
    column = error.offset - text.rfind("\n", 0, error.offset)
    return DefinitionError(f"{name}.idl, line {line}, column {column}: {error}")
