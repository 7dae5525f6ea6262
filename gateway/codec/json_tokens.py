# SPDX-License-Identifier: Apache-2.0
"""NaN, Infinity and -Infinity as clients write them: tokens that JSON does not have.

Python's ``json`` writes them unless it is told not to. The parser refuses them. So
integers that stand nowhere in the text take their places, and the parser reads the text again. Then
the numbers replace the integers. Everything else is as strict as without.
"""

import json
import math
import re
import sys
from itertools import chain
from typing import Any, Final

import orjson

# Of 19 digits, so that each has one spelling, and chosen at random: a text that has them is
# refused, and nobody writes them by accident.
_NUMBERS: Final = {
    7309411264871905843: math.nan,
    7309411264871905844: math.inf,
    7309411264871905845: -math.inf,
}
_MARK: Final = b"730941126487190584"
_TOKENS: Final = {b"NaN": b"3", b"-Infinity": b"5", b"Infinity": b"4"}  # and their last digits

# A token is a value: something before it, and the end or something other than a colon behind it.
# Its letters come first, because what begins by a lookbehind is tried at every character.
_VALUES: Final = {
    token: re.compile(token + rb"(?<![^\s,:\[]" + token + rb")(?=[ \t\r\n]*(?:[,\]}]|\Z))")
    for token in _TOKENS
}

# The closing quote is optional, or the search would retry a string without one. It never
# backtracks. Possessive quantifiers, which Python 3.10 lacks, save the memory for that.
_ALL: Final = b"*+" if sys.version_info >= (3, 11) else b"*"
_STRINGS: Final = re.compile(rb'("[^"\\]%b(?:\\.[^"\\]%b)%b"?)' % (_ALL, _ALL, _ALL), re.DOTALL)

_CONTAINERS: Final = frozenset({dict, list})


def is_at_token(error: orjson.JSONDecodeError) -> bool:
    """Return whether a text was refused at one of the tokens."""
    return error.doc.startswith(("NaN", "Infinity"), error.pos)


def without_tokens(data: bytes) -> bytes | None:
    """Return the text with integers for the tokens that stand for values outside of strings.

    Return ``None`` if it holds such an integer already.
    """
    if _MARK in data:
        return None
    pieces = _STRINGS.split(data)
    # strings are odd pieces. Between the others a quote stands for each of them
    text = b'"'.join(pieces[::2])
    for token, digit in _TOKENS.items():
        if token in text:
            text = _VALUES[token].sub(_MARK + digit, text)
    pieces[::2] = text.split(b'"')
    return b"".join(pieces)


def with_numbers(value: object) -> object:
    """Put the numbers into what was read from `without_tokens`, and return it."""
    whole: list[Any] = [value]
    level: list[Any] = [whole]
    while level:
        objects = [each for each in level if type(each) is dict]
        arrays = [each for each in level if type(each) is list]
        for members in objects:
            for name, item in members.items():
                if type(item) is int and item in _NUMBERS:
                    members[name] = _NUMBERS[item]
        for array in arrays:
            array[:] = [_NUMBERS.get(item, item) if type(item) is int else item for item in array]
        items = chain(chain.from_iterable(map(dict.values, objects)), chain.from_iterable(arrays))
        level = [item for item in items if type(item) in _CONTAINERS]
    return whole[0]


def in_original(error: orjson.JSONDecodeError, data: bytes) -> json.JSONDecodeError:
    """Return an error about the text of `without_tokens` with its place in the text before."""
    before = error.doc[: error.pos]
    for token, digit in _TOKENS.items():
        before = before.replace((_MARK + digit).decode(), token.decode())
    return json.JSONDecodeError(error.msg, data.decode(), len(before))
