# SPDX-License-Identifier: Apache-2.0
"""All texts follow the rules of tools/check_words.py, as far as the record says."""

from collections import Counter

import pytest

from tools.check_words import REPOSITORY, as_toml, count, faults, files, lowered, recorded
from tools.words.block import Block
from tools.words.code import c_blocks, html_blocks, python_blocks, script_blocks
from tools.words.markdown import markdown_blocks
from tools.words.summary import Summary

# Their counts are 0 and stay so.
FAULTLESS = (
    "README.md",
    "docs/tutorials/",
    "docs/how-to/",
    "docs/benchmarks.md",
    "CONTRIBUTING.md",
)


def rules_and_lines(name, source):
    return [(fault.rule, fault.line) for fault in faults(name, source)]


def test_no_file_breaks_a_rule_more_often_than_recorded():
    record = recorded(REPOSITORY)
    found = [
        f"{name}: {rule}: {number}, at most {record.get(name, {}).get(rule, 0)}"
        for name, rules in count(REPOSITORY, files(REPOSITORY, ["."])).items()
        for rule, number in rules.items()
        if number > record.get(name, {}).get(rule, 0)
    ]
    assert not found, "see `python tools/check_words.py FILE`:\n" + "\n".join(found)


def test_tutorials_and_how_to_pages_break_no_rule():
    names = [name for name in recorded(REPOSITORY) if name.startswith(FAULTLESS)]
    assert names == []


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("w " * 31, [("sentence", 1)]),
        ("One.\n\nIt works; it stops.\n", [("semicolon", 3)]),
        ("It works.\nWhat it does is good.\n", [("clause", 2)]),
        ("- Who drives it stops it.\n", [("clause", 1)]),
        ("Send it\nanew.\n", [("avoid", 2)]),
        ("It stops, too.\n", [("avoid", 1)]),
        ("A queue of its\nown.\n", [("avoid", 1)]),
        ("| a | |\n|---|---|\n| 1 | 2 |\n", [("header", 1)]),
        ("| a |\n|---|\n| " + "word. " * 26 + "|\n", [("cell", 3)]),
        ("It is good. " * 31, [("paragraph", 1), ("line", 1)]),
        ("> **Note:** it works; it stops.\n", [("semicolon", 1)]),
    ],
)
def test_a_broken_rule_is_found_with_its_line(source, expected):
    assert sorted(rules_and_lines("page.md", source)) == sorted(expected)


@pytest.mark.parametrize(
    "source",
    [
        "---\ntitle: a; b\n---\nIt works.\n",
        "```sh\na; b\n```\n",
        "1. Run\n   ```sh\n   a; b\n   ```\n",
        'Say `a; b` and "c; d".\n',
        "<!-- a; b -->\n",
        "What does it do? It works.\n",
        "## What it does\n",
        "There is no map.\n",
        "Add classes of your own types.\n",
        "It is no longer there.\n",
        "See [the page](a;b.md).\n",
        "| What | Where |\n|---|---|\n| a | b |\n",
        "It is too long, too slow, and too loud.\n",
    ],
)
def test_good_words_have_no_fault(source):
    assert rules_and_lines("page.md", source) == []


def test_comments_docstrings_texts_and_test_names_of_python_are_read():
    source = (
        '"""One; two.\n\n    code::\n\n        a; b\n"""\n'
        "# three; four\n"
        "def test_it_works_anew(x):\n"
        '    raise ValueError(f"it works with {x}; it stops")  # five; six\n'
    )
    expected = [("semicolon", line) for line in (1, 7, 9, 9)] + [("avoid", 8)]

    assert sorted(rules_and_lines("gateway/one.py", source)) == sorted(expected)


def test_texts_of_tests_are_not_read():
    assert rules_and_lines("tests/one.py", 'x = "it works well; it stops"\n') == []


def test_comments_and_texts_of_javascript_are_read():
    source = (
        "// one; two\nconst a = /[\"';]/; /** three\n * four; five */\n"
        "show('it works for you; it stops');\nb = 'c;d';\n"
    )

    assert [block.line for block in c_blocks(source, has_texts=True)] == [1, 2, 4]
    assert len(rules_and_lines("gateway/one.js", source)) == 3


def test_texts_of_a_page_are_read_without_its_scripts():
    source = "<p>It works;\n<b>it</b> stops.</p><script>a; b</script><img alt='It is on the left'>"

    assert [block.text for block in html_blocks(source)] == [
        "It works; it stops.",
        "It is on the left",
    ]


def test_comments_and_help_of_a_makefile_are_read():
    source = "# SPDX-License-Identifier: x\n# one\n# two\nmake: all ## three\n\tfour # five\n"

    assert script_blocks(source) == [Block(2, "prose", "one\ntwo"), Block(4, "string", "three")]


def test_paragraphs_of_a_docstring_are_read_one_by_one():
    source = '"""One.\n\nArgs:\n    a: Two\n        three.\n    b: Four.\n"""\n'

    assert [(block.line, block.text) for block in python_blocks(source, has_texts=False)] == [
        (1, "One."),
        (4, "a: Two\nthree."),
        (6, "b: Four."),
    ]


def test_sentences_end_at_full_stops_and_not_at_abbreviations():
    [block] = markdown_blocks("One, e.g. this. `Two` is\nhere! (Three.)\n")

    assert list(block.sentences()) == [
        (1, "One, e.g. this."),
        (1, "X is here!"),
        (2, "(Three.)"),
    ]


def test_the_record_only_falls():
    old = {"a.md": {"avoid": 2, "line": 1}, "b.md": {"line": 1}}
    new = {"a.md": Counter(avoid=1, line=4, clause=1), "c.md": Counter(line=1)}

    assert lowered(old, new) == {"a.md": {"avoid": 1, "line": 1}}


def test_the_record_is_sorted_and_leaves_out_what_is_zero():
    text = as_toml({"b.md": {"line": 1, "avoid": 2}, "a.md": {"line": 0}})

    assert text.endswith('\n"b.md" = { avoid = 2, line = 1 }\n')
    assert "a.md" not in text


def test_a_summary_counts_words_sentences_and_how_the_reader_is_addressed():
    summary = Summary()
    summary.add(markdown_blocks("Run it on your robot. It works; it stops.\n"))

    assert str(summary).split() == ["9", "4.5", "0.0%", "111.1", "222.2"]
