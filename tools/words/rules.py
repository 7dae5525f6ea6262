# SPDX-License-Identifier: Apache-2.0
"""The rules of the words: each finds its faults in a block."""

import re
from collections.abc import Callable, Iterator
from typing import NamedTuple

from tools.words.block import Block, words

MAX_WORDS_OF_A_SENTENCE = 30
MAX_WORDS_OF_A_CELL = 25
MAX_WORDS_OF_A_PARAGRAPH = 90
MAX_CHARACTERS_OF_A_LINE = 120

# After "of its own" a noun is fine: "classes of your own types".
_NOUN = r"(?!(?:and|as|at|by|for|from|if|in|is|on|or|so|that|to|too|when|which|while|with)\b)[a-z]"
# Words to avoid, and words to use instead.
AVOIDED = (
    (r"anew", "again, from scratch"),
    (r"for ever", "forever"),
    (r"thrice", "three times"),
    (r"time-outs?", "timeout"),
    (r"patience", "timeout, time limit"),
    (r"in vain", "say what failed"),
    (r"beside", "next to, in addition to, except"),
    (r"but for", "except, except for"),
    (r"any longer", "no longer, still"),
    (rf"of (?:its|their|your|his|our|my|one's) own(?! {_NOUN})|of yours", "its, your, a separate"),
    (r"some(?= \d+)", "about"),
    (r"(?:is|are|was|were) none", "is missing, is not available"),
    (
        r"(?<!there )(?<!here )(?:is|are|was|were) no(?= (?!longer\b|more\b|less\b|fewer\b))",
        "is not a, is missing, is unknown",
    ),
    (r"whoever|somebody", "a client, a program, you"),
    (r"shall", "must, will"),
    (r"meanwhile", "while, at the same time"),
    (r"message table", "list of message types"),
    (r"(?:goes?|went) dark", "the connection is lost"),
    (r"now also|of before|was tried", "the present state only"),
)
_AVOIDED = tuple(
    (re.compile(rf"\b(?:{pattern})\b", re.IGNORECASE), advice) for pattern, advice in AVOIDED
)
_ALL = "|".join(pattern for pattern, _ in AVOIDED)
_ANY_AVOIDED = re.compile(rf"\b(?:{_ALL})\b|, too", re.IGNORECASE)
_TOO = re.compile(r", too(?= ?(?:[.,;:!?)]|$))")
_CLAUSE = re.compile(
    r"^[\W_]*(?:who|whoever|what|whatever|where|wherever)\b(?!\s+to\b)", re.IGNORECASE
)
_SEMICOLON = re.compile(r";")


class Fault(NamedTuple):
    """A broken rule, its line, and the words that break it."""

    line: int
    rule: str
    text: str


def _long_sentences(block: Block) -> Iterator[Fault]:
    for line, sentence in block.sentences():
        count = len(words(sentence))
        if count > MAX_WORDS_OF_A_SENTENCE:
            yield Fault(line, "sentence", f"{count} words: {sentence}")


def _semicolons(block: Block) -> Iterator[Fault]:
    for found in _SEMICOLON.finditer(block.text):
        yield Fault(block.line_at(found.start()), "semicolon", _around(block.text, found))


def _clauses(block: Block) -> Iterator[Fault]:
    for line, sentence in block.sentences():
        is_label = len(words(sentence)) < 4 and block.kind != "name"
        if _CLAUSE.match(sentence) and not is_label and not sentence.endswith("?"):
            yield Fault(line, "clause", sentence)


def _avoided(block: Block) -> Iterator[Fault]:
    text_in_one_line = block.text.replace("\n", " ")
    if not _ANY_AVOIDED.search(text_in_one_line):
        return
    for pattern, advice in (*_AVOIDED, (_TOO, "also")):
        for found in pattern.finditer(text_in_one_line):
            text = f"{_around(block.text, found)} ({advice})"
            yield Fault(block.line_at(found.start()), "avoid", text)


def _long_cell(block: Block) -> Iterator[Fault]:
    count = len(words(block.text))
    if count > MAX_WORDS_OF_A_CELL:
        yield Fault(block.line, "cell", f"{count} words: {block.text}")


def _missing_header(block: Block) -> Iterator[Fault]:
    if not block.text.strip():
        yield Fault(block.line, "header", "a table column has no header")


def _long_paragraph(block: Block) -> Iterator[Fault]:
    count = len(words(block.text))
    if count > MAX_WORDS_OF_A_PARAGRAPH:
        yield Fault(block.line, "paragraph", f"{count} words: {' '.join(block.text.split())[:60]}")


def _around(text: str, found: re.Match[str]) -> str:
    start = max(text.rfind(" ", 0, max(found.start() - 25, 0)) + 1, 0)
    end = text.find(" ", found.end() + 25)
    return " ".join(text[start : end if end > 0 else None].split())


_OF_PROSE: tuple[Callable[[Block], Iterator[Fault]], ...] = (
    _long_sentences,
    _semicolons,
    _clauses,
    _avoided,
)
_OF_KIND: dict[str, tuple[Callable[[Block], Iterator[Fault]], ...]] = {
    "prose": (*_OF_PROSE, _long_paragraph),
    "heading": (_semicolons, _avoided),
    "header": (_missing_header, _semicolons, _avoided),
    "cell": (_long_cell, *_OF_PROSE),
    "string": _OF_PROSE,
    "name": (_clauses, _avoided),
}


def faults_of(block: Block) -> Iterator[Fault]:
    """Yield each broken rule of a block."""
    for rule in _OF_KIND[block.kind]:
        yield from rule(block)
