# SPDX-License-Identifier: Apache-2.0
"""Docstrings are in plain English, as CONTRIBUTING.md asks."""

import ast
import re

import pytest

from tests.test_sizes import REPOSITORY, source_files

# Words that a docstring must not contain, and words to write instead.
RULES = (
    (
        re.compile(r"\A\s*(?:What|Where|Who|Whose|Whether|Which|How|When|Whenever)\b"),
        'begin with an imperative or a noun phrase, such as "Return whether" or "The time of"',
    ),
    (
        re.compile(r"\bis\s+(?:none|no\s+such)\b|\bunknown\s+ones\s+are\s+none\b"),
        'say what happens, such as "unknown ids are ignored" or "returns None if"',
    ),
    (
        re.compile(r"\b[Tt]ell\s+(?:the|of)\b|\b[Tt]ells\b|\btold\s+of\b"),
        'write "report", "send", "answer" or "say"',
    ),
    (
        re.compile(r"\b(?:[Ww]hat|[Ww]ho)\s+(?:is|are)\s+no\b(?!\s+longer)"),
        'name the thing, such as "bytes that are not a request"',
    ),
)


def faults(name, source):
    """Return a line for each broken rule: file, line of the docstring, words, advice."""
    found = []
    for node in ast.walk(ast.parse(source)):
        match node:
            case ast.Expr(ast.Constant(str(text))):
                for pattern, advice in RULES:
                    if words := pattern.search(text):
                        place = f"{name}:{node.lineno}"
                        found.append(f"{place}: {' '.join(words[0].split())!r}: {advice}")
    return found


def test_docstrings_are_in_plain_english():
    texts = {name: (REPOSITORY / name).read_text(encoding="utf-8") for name in source_files()}
    found = [line for name, text in texts.items() for line in faults(name, text)]
    assert not found, "\n".join(found)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("What it holds.", "What"),
        ("Whether it is open.", "Whether"),
        ("Close it.\n\n    An unknown id is\n    none.", "is none"),
        ("Return it, or nothing if there is no such topic.", "is no such"),
        ("Close one; unknown ones are none.", "unknown ones are none"),
        ("Tell the clocks.", "Tell the"),
        ("The id tells them apart.", "tells"),
        ("Nodes of another version are told of.", "told of"),
        ("Answer what is no request.", "what is no"),
    ],
)
def test_a_fault_is_reported_with_its_place_and_words(text, words):
    source = f'def close():\n    """{text}"""\n'

    [fault] = faults("one.py", source)

    assert fault.startswith(f"one.py:2: {words!r}: ")


@pytest.mark.parametrize("text", ["Return whether it is open.", "The words, however many."])
def test_plain_english_has_no_fault(text):
    assert faults("one.py", f'"""{text}"""') == []
