# SPDX-License-Identifier: Apache-2.0
"""A piece of text that a person reads, and its sentences."""

import re
from collections.abc import Iterator
from typing import Literal, NamedTuple

Kind = Literal["prose", "heading", "header", "cell", "string", "name"]

_ABBREVIATION = re.compile(r"\b(e\.g|i\.e|etc|vs|approx|No|cf)\.(?!\s*$)")
_END_OF_SENTENCE = re.compile(r"(?<=[.!?])[\"')\]*_]*\s+(?=[\"'(\[*_]*[A-Z0-9])")


class Block(NamedTuple):
    """Text from *line* on: a paragraph, a list item, a cell, a comment, or a string."""

    line: int
    kind: Kind
    text: str

    def line_at(self, offset: int) -> int:
        """Return the line of a character of the text."""
        return self.line + self.text.count("\n", 0, offset)

    def sentences(self) -> Iterator[tuple[int, str]]:
        """Yield the line and the text of each sentence."""
        text = _ABBREVIATION.sub(lambda found: found[0][:-1] + "\N{ONE DOT LEADER}", self.text)
        start = 0
        for end in _END_OF_SENTENCE.finditer(text):
            yield self.line_at(start), _one_line(text[start : end.start()])
            start = end.end()
        if text[start:].strip():
            yield self.line_at(start), _one_line(text[start:])


def _one_line(text: str) -> str:
    return " ".join(text.replace("\N{ONE DOT LEADER}", ".").split())


def words(text: str) -> list[str]:
    """Return the words of *text*: what has a letter or a digit."""
    return [word for word in text.split() if any(letter.isalnum() for letter in word)]


_CODE = re.compile(r"(?<!`)(`+)(?!`)(?:.+?)(?<!`)\1(?!`)", re.DOTALL)
_IMAGE = re.compile(r"!\[[^\]]*\]\([^)]*\)")
_LINK = re.compile(r"\[((?:[^\[\]]|\[[^\]]*\])*)\](?:\([^)\s]*(?:\s+\"[^\"]*\")?\)|\[[^\]]*\])")
_ADDRESS = re.compile(r"<?\b(?:https?|wss?|file)://[^\s>)]*>?")
_TAG = re.compile(r"</?[a-zA-Z][^<>]*>")
_ENTITY = re.compile(r"&(?:#\w+|\w+);")
_QUOTE = re.compile(r"(?<![\w])\"[^\"]{1,400}?\"(?!\w)|“[^”]{1,400}”", re.DOTALL)
_FIELD = re.compile(r"%\(\w+\)[sd]|%[sd]|(?<![\w-])--[a-z][\w-]*")  # also an option


def plain(text: str) -> str:
    """Return *text* with one word for each piece of code, address and quote, lines kept."""
    text = _CODE.sub(_one_word, text)
    text = _IMAGE.sub(_nothing, text)
    text = _LINK.sub(lambda found: found[1], text)
    text = _ADDRESS.sub(_one_word, text)
    text = _TAG.sub(_nothing, text)
    text = _ENTITY.sub("-", text)
    text = _FIELD.sub("X", text)
    return _QUOTE.sub(_one_word, text)


def _one_word(found: re.Match[str]) -> str:
    end = "." if re.search(r"[.!?][\"”]\Z", found[0]) else ""
    return "X" + end + "\n" * found[0].count("\n")


def _nothing(found: re.Match[str]) -> str:
    return "\n" * found[0].count("\n")
