# SPDX-License-Identifier: Apache-2.0
"""The texts of the pages: each language has all of them, and the code has none."""

import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

PAGES = Path(__file__).parents[2] / "gateway/fronts/pages"
LANGUAGES = """async () => {
    const { LANGUAGES } = await import("/shared/language.js");
    const files = Object.keys(LANGUAGES).map(async (each) =>
        [each, (await import(`/words/${each}.js`)).default]);
    return Object.fromEntries(await Promise.all(files));
}"""
# a key in quotes or, put together, in backticks. Other functions of the name `say` get sentences
KEY = re.compile(
    r"""\b(?:say|count)\((["`])([a-z](?:[\w.]|\$\{[^}]+\})*)\1|data-say(?:-\w+)?="([^"]+)\""""
)
COMMENT = re.compile(r"^\s*/?\*.*|(?:^|\s)//.*")
CODE_IN_TEXT = re.compile(r"\$\{[^{}\"'`]*\}")
LITERAL = re.compile(r"\"((?:[^\"\\]|\\.)*)\"|'((?:[^'\\]|\\.)*)'|`((?:[^`\\$]|\\.|\$(?!\{))*)`")
# two words, or one that begins with a capital letter
WORDS = re.compile(r"[A-Za-z]{2}[,.:;]? (?:[A-Za-z]{2}|a )|^ ?[A-Z][a-z]+$")
# any word that becomes a text, a label, a hint or the content of an element
SHOWN = re.compile(
    r"(?:\b(?:title|label|placeholder|description)\"?:|\btextContent =|element\(\"\w+\", \{.*\},)"
    r" [\"`]([^\"`$]*[a-z]{2}[^\"`$]*)"
)
NOT_WORDS = re.compile(
    # keys of a keyboard, commands, fonts, and rules of CSS
    r"Alt|Arrow|Control|End|Enter|Escape|Home|Meta|Space|Tab|↑ ↓ Home End"
    r"|ros2-gateway .+|.+(sans-serif|monospace|system-ui)|\(.+: .+\)"
    r"|(also )?ghost( more)?|(button|input|select)[^ ]*, .+|\*, .+|image init_from"
    # a mistake in the code
    r"|no words for …"
    # names that are the same in all languages, units, and fields of a message
    r"|ROS 2 gateway|English|Suomi|Infinity|Ah|Pa|sec nanosec"
)
ELSEWHERE = (
    "vendor", "words",
    "shared/cbor.js",  # as the errors of the browser are, which stand next to them
    "shared/control_words.js",  # the words of the gateway, by which it tells them apart
)  # fmt: skip


def used() -> set[str]:
    """Return the keys of all texts that the pages use. A key that is put together is a pattern."""
    sources = [each for kind in ("*.js", "*.html") for each in PAGES.rglob(kind)]
    found = [
        keys
        for each in sources
        if each.parent.name not in {"vendor", "words"}
        for keys in KEY.findall(each.read_text())
    ]
    return {re.sub(r"\\\$\\\{[^}]*\}", ".+", re.escape(one or other)) for _, one, other in found}


@pytest.mark.asyncio(loop_scope="package")
async def test_all_languages_have_the_same_texts_with_the_same_values_and_all_are_used(evaluate):
    for each in (PAGES / "words").glob("*.js"):
        keys = re.findall(r'^  "([^"]+)":', each.read_text(), re.MULTILINE)
        assert [key for key, number in Counter(keys).items() if number > 1] == []
    words = await evaluate(LANGUAGES)
    assert {each.stem for each in (PAGES / "words").glob("*.js")} == set(words)
    values = {
        language: {key: sorted(re.findall(r"\{(\w+)\}", text)) for key, text in texts.items()}
        for language, texts in words.items()
    }
    for each in values.values():
        assert each == values["en"]
    patterns = {f"{each}(?:\\.(?:one|other))?" for each in used()}
    keys = set(words["en"])
    assert [key for key in keys if not any(re.fullmatch(each, key) for each in patterns)] == []
    assert [each for each in patterns if not any(re.fullmatch(each, key) for key in keys)] == []


def literals(line: str) -> Iterator[str]:
    """Yield the texts in a line of code, without the code in them, which may have texts too."""
    line = COMMENT.sub("", line)
    while True:
        line = CODE_IN_TEXT.sub("…", line)
        found = LITERAL.search(line)
        if not found:
            return
        yield next(each for each in (*found.groups(), "") if each is not None)
        line = line[: found.start()] + "0" + line[found.end() :]


def texts_in(source: str) -> list[str]:
    """Return the texts in code that people would read, as far as their form tells."""
    found = [
        text
        for line in source.splitlines()
        for text in (
            *(each for each in literals(line) if WORDS.search(each)),
            *SHOWN.findall(COMMENT.sub("", line)),
        )
    ]
    return [each for each in dict.fromkeys(found) if not NOT_WORDS.fullmatch(each)]


@pytest.mark.parametrize(
    ("line", "texts"),
    [
        ('tell(`${x} is now ${set ? "as set" : "old"}`)', ["as set", "… is now …"]),
        ('element("pre", { aria: { label: say("x") } }, "feedback")', ["feedback"]),
        ('element("pre", { title: "feedback" }, say("goal.feedback"))', ["feedback"]),
        ('element("pre", { className: "raw" }) // a word or two', []),
        ('addEventListener("keydown", ({ key }) => key === "Escape")', []),
    ],
)  # fmt: skip
def test_texts_in_code_are_found(line, texts):
    assert texts_in(line) == texts


def test_the_code_of_the_pages_has_no_texts():
    found = {
        name: texts
        for each in sorted(PAGES.rglob("*.js"))
        if not (name := each.relative_to(PAGES).as_posix()).startswith(ELSEWHERE)
        if (texts := texts_in(each.read_text()))
    }
    assert found == {}
