# SPDX-License-Identifier: Apache-2.0
"""The fenced blocks of a page, for tests that execute them and compare what they print."""

import re
import textwrap
from pathlib import Path
from typing import NamedTuple

DOCS = Path(__file__).parents[1] / "docs"

_FENCED = re.compile(r"^( *)```([a-z]+)\n(.*?)^ *```$", re.MULTILINE | re.DOTALL)


class Block(NamedTuple):
    """A fenced block."""

    language: str
    text: str


def blocks(page: str) -> list[Block]:
    """Return the blocks of a page below docs/, in their order."""
    text = (DOCS / page).read_text(encoding="utf-8")
    return [Block(found[2], textwrap.dedent(found[3])) for found in _FENCED.finditer(text)]


def texts(page: str, language: str) -> list[str]:
    """Return the texts of the blocks in one language."""
    return [block.text for block in blocks(page) if block.language == language]


def with_outputs(page: str, language: str) -> list[tuple[str, list[str]]]:
    """Return the blocks in one language, each with the lines of the output that follows it."""
    found: list[tuple[str, list[str]]] = []
    for block in blocks(page):
        if block.language == language:
            found.append((block.text, []))
        elif block.language == "text" and found:
            found[-1][1].extend(block.text.splitlines())
    return found


def protocol_examples() -> list[str]:
    """Return the conversations on the pages of the protocol, in which `> ` marks sent lines."""
    pages = sorted((DOCS / "reference/protocol").glob("*.md"))
    return [text for page in pages for text in texts(str(page.relative_to(DOCS)), "wscat")]


def is_like(shown: str, line: str) -> bool:
    """Return whether a line is as the page shows it, where `...` stands for any text."""
    pattern = ".*".join(re.escape(part) for part in shown.split("..."))
    return re.fullmatch(pattern, line) is not None
