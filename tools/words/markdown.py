# SPDX-License-Identifier: Apache-2.0
"""Paragraphs, list items, headings and table cells of a Markdown page, without its code."""

import re
from collections.abc import Iterator

from tools.words.block import Block, Kind, plain

_FENCE = re.compile(r"^[\s>]*(?:[-*+]\s+|\d+\.\s+)?(```+|~~~+)")
_COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)
_QUOTE_MARK = re.compile(r"^\s*(?:>\s?)+(?:\[!\w+\]\s*$)?")
_ITEM = re.compile(r"^(\s*)(?:[-*+]|\d+[.)])\s+(?:\[[ x]\]\s+)?")
_HEADING = re.compile(r"^#{1,6}\s+")
_ADMONITION = re.compile(r"^\s*(?:!!!|\?\?\?\+?|===)\s+(?:[a-z]+\s*)?")
_DEFINITION = re.compile(r"^\s*\[[^\]]+\]:\s")
_RULE = re.compile(r"^\s*(?:[-*_]\s*){3,}$|^\s*=+\s*$")
_DELIMITER = re.compile(r"^\s*\|?[\s:|-]*-[\s:|-]*\|?\s*$")
_CELLS = re.compile(r"(?<!\\)\|")
_CODE = re.compile(r"(?<!`)(`+)(?!`).+?(?<!`)\1(?!`)")


def text_lines(source: str) -> Iterator[tuple[int, str]]:
    """Yield number and text of each line. Lines of code, comments and front matter are empty."""
    source = _COMMENT.sub(lambda found: "\n" * found[0].count("\n"), source)
    lines = source.splitlines()
    skipped_until = r"---\s*$" if lines and lines[0].rstrip() == "---" else ""
    for number, line in enumerate(lines, 1):
        fence = _FENCE.match(line)
        if skipped_until:
            if number > 1 and re.match(skipped_until, line):
                skipped_until = ""
            yield number, ""
        elif fence:
            skipped_until = rf"^[\s>]*{fence[1]}\s*$"
            yield number, ""
        else:
            yield number, line


class _Page:
    """Collects lines into blocks."""

    def __init__(self) -> None:
        self.blocks: list[Block] = []
        self._open: list[str] = []
        self._line = 0
        self._kind: Kind = "prose"
        self._in_table = False
        self._in_list = False

    def add(self, number: int, line: str) -> None:
        line = _QUOTE_MARK.sub("", line)
        if line.lstrip().startswith("|"):
            self._add_row(number, line)
            return
        self._in_table = False
        if not line.strip() or _RULE.match(line) or _DEFINITION.match(line):
            self.close()
        elif line.startswith("    ") and not self._open and not self._in_list:
            pass  # indented code
        elif heading := _HEADING.match(line):
            self._start(number, line[heading.end() :], "heading")
            self.close()
            self._in_list = False
        elif mark := _ITEM.match(line) or _ADMONITION.match(line):
            self._start(number, line[mark.end() :], "prose")
            self._in_list = True
        elif self._open:
            self._open.append(line.strip())
        else:
            self._in_list = self._in_list and line.startswith(" ")
            self._start(number, line.strip(), "prose")

    def _start(self, number: int, text: str, kind: Kind) -> None:
        self.close()
        self._open, self._line, self._kind = [text], number, kind

    def close(self) -> None:
        if self._open:
            self.blocks.append(Block(self._line, self._kind, plain("\n".join(self._open))))
            self._open = []

    def _add_row(self, number: int, line: str) -> None:
        self.close()
        kind: Kind = "cell" if self._in_table else "header"
        self._in_table = True
        if _DELIMITER.match(line):
            return
        line = _CODE.sub(lambda found: found[0].replace("|", "/"), line.strip())
        for cell in _CELLS.split(line.strip().removeprefix("|").removesuffix("|")):
            self.blocks.append(Block(number, kind, plain(cell.strip())))


def markdown_blocks(source: str) -> list[Block]:
    """Return what a person reads on a page."""
    page = _Page()
    for number, line in text_lines(source):
        page.add(number, line)
    page.close()
    return page.blocks
