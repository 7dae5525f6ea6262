# SPDX-License-Identifier: Apache-2.0
"""Each text of the page for troubleshooting is one that the code shows."""

import ast
import re
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np

from tests.doc_blocks import DOCS, texts

ROOT = Path(__file__).parents[1]
PAGE = "troubleshooting.md"
LINES = [line for block in texts(PAGE, "text") for line in block.splitlines()]
ENTRIES = re.split(r"^### ", (DOCS / PAGE).read_text(encoding="utf-8"), flags=re.MULTILINE)[1:]

MIN_ENTRIES = 20
_JAVASCRIPT = re.compile(r'"([^"\n]*)"|`([^`\n]*)`')
_VALUES = re.compile(
    r"\$\{[^}]*\}|\{[a-z_]*\}|\s*\n\s*|(?<=\.) "
)  # and ends of lines and sentences
# the rest once the parts are taken out: names, numbers, seconds, roles, words in capitals
_VALUE = re.compile(r"[^a-z]*|\S*[/_.\d]\S*|s|operator|admin|page")


@cache
def parts() -> list[str]:
    """Return what stands between the values in each text of the code, the longest first."""
    found: set[str] = set()
    numpy_on_1 = Path(np.__file__).parent / "core/_multiarray_umath.py"  # of NumPy 2
    files = [file for folder in ("gateway", "schemas") for file in (ROOT / folder).rglob("*.py")]
    for file in [*files, *([numpy_on_1] if numpy_on_1.exists() else [])]:
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                found |= set(_VALUES.split(node.value))
    for file in (ROOT / "gateway/fronts/pages").rglob("*.js"):
        for quoted in _JAVASCRIPT.findall(file.read_text(encoding="utf-8")):
            found |= set(_VALUES.split("".join(quoted)))
    return sorted((part for part in found if " " in part), key=len, reverse=True)


def unknown_words(line: str) -> list[str]:
    """Return the words of a line that are neither the code's nor a value."""
    left = [line]
    for part in parts():
        left = [rest for each in left for rest in each.split(part)]
    return [word for each in left for word in each.split() if not _VALUE.fullmatch(word)]


def test_a_text_that_the_page_shows_is_one_of_the_code():
    assert {line: words for line in LINES if (words := unknown_words(line))} == {}


def test_a_text_that_the_code_does_not_show_is_found():
    line = 'topic /cmd_vel is parked, commands ceased: publish a command of zero ("msg":{})'
    assert "parked" in unknown_words(line)


def test_each_entry_has_its_cause_and_its_cure():
    assert len(ENTRIES) >= MIN_ENTRIES
    for entry in ENTRIES:
        assert "**Cause:**" in entry, entry
        assert "**Cure:**" in entry, entry
    titles = [entry.splitlines()[0] for entry in ENTRIES]
    assert not [one for one, other in pairwise(sorted(titles)) if one == other]
