# SPDX-License-Identifier: Apache-2.0
"""Figures of a text: how long its sentences are, and how it speaks to its reader."""

import re
from collections.abc import Iterable
from typing import Self

from tools.words.block import Block, words
from tools.words.rules import MAX_WORDS_OF_A_SENTENCE

HEADER = f"{'words':>7} {'mean':>5} {'>30':>6} {';/1000':>7} {'you/1000':>9}"
_KINDS = ("prose", "cell", "string")
_YOU = re.compile(r"\b(?:you|your|yours)\b", re.IGNORECASE)
_IMPERATIVE = re.compile(
    r"^[\W_]*(?:(?:then|to [^,]{1,60},|if [^,]{1,60},)\s+)?(?:add|allow|ask|avoid|build|call|"
    r"change|check|choose|click|close|compare|connect|copy|create|cut|do|download|drive|edit|end|"
    r"enter|find|follow|give|go|install|keep|leave|let|limit|look|make|measure|move|name|open|pass|"
    r"paste|pick|press|print|publish|put|read|remove|repeat|replace|restart|run|see|select|"
    r"send|set|show|start|stop|store|subscribe|take|test|try|turn|type|unpack|update|use|wait|"
    r"write)\b",
    re.IGNORECASE,
)


class Summary:
    """Counts of one text or of many."""

    def __init__(self) -> None:
        self.words = self.semicolons = self.addresses = 0
        self.sentences = self.sentence_words = self.long = 0

    def add(self, blocks: Iterable[Block]) -> None:
        """Count prose, table cells and texts. Headings and names are left out."""
        for block in blocks:
            if block.kind in _KINDS:
                self.semicolons += block.text.count(";")
                for _, sentence in block.sentences():
                    self._add_sentence(sentence, block.kind == "prose")

    def _add_sentence(self, sentence: str, counts_length: bool) -> None:
        count = len(words(sentence))
        self.words += count
        self.addresses += len(_YOU.findall(sentence)) + bool(_IMPERATIVE.match(sentence))
        if counts_length and count > 1:
            self.sentences += 1
            self.sentence_words += count
            self.long += count > MAX_WORDS_OF_A_SENTENCE

    def merge(self, other: Self) -> None:
        """Add the counts of another text."""
        for name, value in vars(other).items():
            setattr(self, name, getattr(self, name) + value)

    def __str__(self) -> str:
        mean = self.sentence_words / max(self.sentences, 1)
        share = self.long / max(self.sentences, 1)
        thousands = max(self.words, 1) / 1000
        return (
            f"{self.words:7} {mean:5.1f} {share:6.1%} {self.semicolons / thousands:7.1f}"
            f" {self.addresses / thousands:9.1f}"
        )
