# SPDX-License-Identifier: Apache-2.0
"""Reads IDL word by word: what declarations are made of, such as names, sizes and annotations."""

from typing import Final

from schemas.definition import FLOATS, INTEGER_RANGES, STRINGS, FieldType, Scalar, Value
from schemas.definition_text import text_misfit
from schemas.idl_tokens import IdlToken, PlaceError, items, number, shortened, string, tokens

MAX_SIZE: Final = 2**32 - 1  # of an array, a sequence or a string: CDR counts in 32 bits
_MAX_FLOAT: Final = 2**1023  # of the integers that a float may be written as

Literal = tuple[IdlToken, Scalar]
"""A value, and the word that it begins with."""


class IdlReader:
    """A text, and the word of it that is next.

    Its methods raise `PlaceError` where they find another word than they read.
    """

    def __init__(self, text: str) -> None:
        self._tokens = tokens(text)
        self.next = next(self._tokens)

    def take(self) -> IdlToken:
        """Return the next word, and go on to the one behind it."""
        token = self.next
        if token.kind != "end":
            self.next = next(self._tokens)
        return token

    def takes(self, symbol: str) -> bool:
        """Go on if the next word is this symbol. Return whether it was."""
        if self.next.kind != "symbol" or self.next.text != symbol:
            return False
        self.take()
        return True

    def expect(self, symbol: str) -> None:
        """Read this symbol."""
        if not self.takes(symbol):
            raise unexpected(symbol, self.next)

    def name(self, what: str) -> IdlToken:
        """Read a name. *what* is it, for the error text."""
        token = self.take()
        if token.kind != "name":
            raise unexpected(what, token)
        return token

    def scoped_name(self, what: str) -> list[str]:
        """Read names with ``::`` between them, and perhaps in front."""
        self.takes("::")
        names = [self.name(what).text]
        while self.takes("::"):
            names.append(self.name(what).text)
        return names

    def size(self) -> int:
        """Read the size of an array, or the bound of a sequence or a string."""
        token = self.take()
        value = number(token) if token.kind == "number" else None
        if not isinstance(value, int) or not 1 <= value <= MAX_SIZE:
            raise unexpected(f"a number from 1 to {MAX_SIZE}; rosidl takes no name or sum", token)
        return value

    def literal(self) -> Literal:
        """Read a number, a string, or TRUE or FALSE."""
        sign = self.next.text if self.next.text in {"+", "-"} else ""
        if sign:
            self.take()
        token = self.take()
        if token.kind == "number":
            value = number(token)
            return token, -value if sign == "-" else value
        if not sign and token.kind == "string":
            texts = [string(token)]
            while self.next.kind == "string":
                texts.append(string(self.take()))
            return token, "".join(texts)
        if not sign and token.text in {"TRUE", "FALSE"}:
            return token, token.text == "TRUE"
        raise unexpected("a number, a string, TRUE or FALSE; rosidl takes no name or sum", token)

    def annotations(self) -> "Annotations":
        """Read the annotations of a declaration. Those that change nothing here are skipped."""
        found = Annotations()
        while self.takes("@"):
            name = self.scoped_name("the name of an annotation")[-1]
            if name in _READ:
                found.setdefault(name, self._parameters())
            elif name == "key":
                found["key"] = self._parameters() if self.next.text == "(" else {}
            elif self.takes("("):
                self._skip_parameters()
        return found

    def _parameters(self) -> dict[str, Literal]:
        self.expect("(")
        found: dict[str, Literal] = {}
        if self.next.kind != "name" or self.next.text in {"TRUE", "FALSE"}:
            found["value"] = self.literal()
        else:
            found |= self._parameter()
            while self.takes(","):
                found |= self._parameter()
        self.expect(")")
        return found

    def _parameter(self) -> dict[str, Literal]:
        name = self.name("the name of a parameter")
        self.expect("=")
        return {name.text: self.literal()}

    def _skip_parameters(self) -> None:
        depth = 1
        while depth:
            token = self.take()
            if token.kind == "end":
                raise unexpected(")", token)
            if token.kind == "symbol":
                depth += {"(": 1, ")": -1}.get(token.text, 0)


_NUMBERS: Final = FLOATS | INTEGER_RANGES.keys()
_READ: Final = frozenset({"default", "unit", "verbatim"})


class Annotations(dict[str, dict[str, Literal]]):
    """The annotations of one declaration that say something here: parameters by name."""

    @property
    def comment(self) -> str:
        """The comment, with the unit where ROS writes it: in brackets at the end."""
        parts = self.get("verbatim", {})
        language, text = parts.get("language"), parts.get("text")
        is_comment = language is not None and language[1] == "comment"
        comment = str(text[1]) if text is not None and is_comment else ""
        unit = self.get("unit", {}).get("value")
        return (comment if unit is None else f"{comment} [{unit[1]}]").strip()

    @property
    def is_key(self) -> bool:
        """True for a key: ``@key`` or ``@key(TRUE)``."""
        parameters = self.get("key")
        given = (parameters or {}).get("value")
        return parameters is not None and (given is None or given[1] is True)

    def default(self, kind: FieldType) -> Value | None:
        """Return the default of a field of this type, or ``None`` without an annotation for it.

        Raises:
            PlaceError: it does not fit the type.
        """
        given = self.get("default", {}).get("value")
        if given is None:
            return None
        token, value = given
        if not kind.is_primitive:
            raise PlaceError(token.offset, f"a {shortened(kind.base)} has no default; leave it out")
        if not kind.is_array:
            return fitting(kind, token, value)
        if not isinstance(value, str):
            raise unexpected('a default such as "(1, 2, 3)"', token)
        values = items(token, value)
        at_most = kind.length or kind.bound or MAX_SIZE
        if len(values) > at_most or (kind.length and len(values) < at_most):
            raise PlaceError(
                token.offset, f"{len(values)} elements are no default of {shortened(str(kind))}"
            )
        return tuple(fitting(kind, token, each) for each in values)


def fitting(kind: FieldType, token: IdlToken, value: Scalar) -> Scalar:
    """Return a value for a constant, a field or an element of this type.

    Raises:
        PlaceError: it is of another type, or out of range.
    """
    if kind.base == "bool" and isinstance(value, bool):
        return value
    if kind.base in STRINGS and isinstance(value, str):
        misfit = text_misfit(value, kind)
        if misfit:
            raise PlaceError(token.offset, misfit)
        return value
    if kind.base in FLOATS and isinstance(value, float):
        return value
    if type(value) is int and kind.base in _NUMBERS:
        low, high = INTEGER_RANGES.get(kind.base, (-_MAX_FLOAT, _MAX_FLOAT))
        if low <= value <= high:
            return float(value) if kind.base in FLOATS else value
    raise unexpected(f"a value of {kind.base}", token)


def unexpected(expected: str, token: IdlToken) -> PlaceError:
    """Return the error about a word that is not the expected one."""
    return PlaceError(token.offset, f"expected {expected}, got {token}")
