# SPDX-License-Identifier: Apache-2.0
"""Comments, docstrings, texts and test names of Python, JavaScript, C#, HTML and scripts."""

import ast
import io
import re
import textwrap
import tokenize
from collections.abc import Iterable, Iterator
from html.parser import HTMLParser

from tools.words.block import Block, plain, words

_DIRECTIVE = re.compile(
    r"^(?:SPDX|!|type:|noqa|ruff:|pragma|mypy:|fmt:|hadolint|shellcheck|@ts-|eslint|<auto-gen)"
)
_SECTION_ENTRY = re.compile(r"^\s*(?:[-*] |\d+\. |\w[\w., *`]{0,40}: )")
_SECTION = re.compile(r"^\s*(?:Args|Returns|Raises|Yields|Attributes|Example|Examples|Note):\s*$")
_DOCTEST = re.compile(r"^\s*(?:>>>|\.\.\. )")
_JSDOC = re.compile(r"^\s*@\w+(?:\s+\{.*\})?(?:\s+\[?[\w.=]+\]?)?\s*-?\s*")
MIN_WORDS_OF_A_SENTENCE = 4  # fewer are a name, a format, or a label


def _paragraphs(lines: Iterable[tuple[int, str]]) -> Iterator[Block]:
    """Yield a block for each paragraph and entry of a comment. Code in it is left out."""
    open_lines: list[str] = []
    first = 0
    for number, line in [*lines, (0, "")]:
        begins = bool(_SECTION_ENTRY.match(line) or _JSDOC.match(line))
        skipped = not line.strip() or bool(_SECTION.match(line) or _DOCTEST.match(line))
        if open_lines and (skipped or begins or number != first + len(open_lines)):
            yield Block(first, "prose", plain("\n".join(open_lines)))
            open_lines = []
        if not skipped:
            first = first if open_lines else number
            open_lines.append(_JSDOC.sub("", line).strip())


def _without_code(text: str) -> str:
    """Return a docstring whose indented code, after ``::`` or a fence, is empty lines."""
    kept, fenced, literal = [], False, False
    for line in text.splitlines():
        if line.lstrip().startswith("```"):
            fenced = not fenced
            kept.append("")
            continue
        literal = literal and (not line.strip() or line.startswith("    "))
        kept.append("" if fenced or literal else line)
        literal = literal or line.rstrip().endswith("::")
    return "\n".join(kept)


def _is_sentence(text: str) -> bool:
    found = words(text)
    letters = sum(letter.isalpha() or letter in " ,.'" for letter in text)
    alphabetic = [word for word in found if re.fullmatch(r"[(\"']*[A-Za-z'-]+[.,:;!?)\"']*", word)]
    return (
        len(found) >= MIN_WORDS_OF_A_SENTENCE
        and len(alphabetic) >= MIN_WORDS_OF_A_SENTENCE - 1
        and letters > 0.85 * len(text)
    )


def _strings(line: int, text: str) -> Iterator[Block]:
    """Yield the parts of a string that read like sentences."""
    for offset, part in enumerate(text.split("\n")):
        clean = plain(part)
        if _is_sentence(clean) and "{" not in clean:
            yield Block(line + offset, "string", clean)


def _comments_of_python(source: str) -> Iterator[Block]:
    lines: list[tuple[int, str]] = []
    trailing: list[tuple[int, str]] = []
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT:
            text = token.string[1:].removeprefix(":").strip()
            if not _DIRECTIVE.match(text):
                is_whole = not token.line[: token.start[1]].strip()
                (lines if is_whole else trailing).append((token.start[0], text))
    yield from _paragraphs(lines)
    for number, text in trailing:
        yield Block(number, "prose", plain(text))


def _text_of(node: ast.expr) -> str:
    match node:
        case ast.Constant(str(text)):
            return text
        case ast.JoinedStr(values):
            return "".join(_text_of(value) for value in values)
        case ast.FormattedValue():
            return "X"
    return ""


class _Texts(ast.NodeVisitor):
    """Collects docstrings, strings and names of tests."""

    def __init__(self, has_texts: bool) -> None:
        self.blocks: list[Block] = []
        self._has_texts = has_texts

    def visit_Expr(self, node: ast.Expr) -> None:
        match node.value:
            case ast.Constant(str(text)):
                first, _, rest = text.partition("\n")
                lines = _without_code(first + "\n" + textwrap.dedent(rest)).splitlines()
                self.blocks.extend(_paragraphs(enumerate(lines, node.lineno)))
            case _:
                self.generic_visit(node)

    def visit_FunctionDef(self, node: ast.FunctionDef | ast.AsyncFunctionDef) -> None:
        if node.name.startswith("test_"):
            text = node.name.removeprefix("test_").replace("_", " ")
            self.blocks.append(Block(node.lineno, "name", text))
        self.generic_visit(node)

    visit_AsyncFunctionDef = visit_FunctionDef  # noqa: N815

    def visit_Constant(self, node: ast.Constant) -> None:
        self._add(node)

    def visit_JoinedStr(self, node: ast.JoinedStr) -> None:
        self._add(node)

    def _add(self, node: ast.Constant | ast.JoinedStr) -> None:
        if self._has_texts:
            self.blocks.extend(_strings(node.lineno, _text_of(node)))


def python_blocks(source: str, has_texts: bool) -> list[Block]:
    """Return comments, docstrings, names of tests, and texts if *has_texts*."""
    texts = _Texts(has_texts)
    texts.visit(ast.parse(source))
    return sorted([*_comments_of_python(source), *texts.blocks])


_TOKEN_OF_C = re.compile(
    r"""(?P<line>//[^\n]*)|(?P<block>/\*.*?\*/)"""
    r"""|(?P<verbatim>\$?@\$?"(?:""|[^"])*")"""
    r"""|(?P<string>"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'|`(?:\\.|[^`\\])*`)"""
    r"""|(?P<regex>[=(,:\[!&|?{};]\s*/(?![*/\s])(?:\\.|\[(?:\\.|[^\]\\\n])*\]|[^/\\\n\[])+/)""",
    re.DOTALL,
)
_HOLE = re.compile(r"\$?\{(?:[^{}]|\{[^{}]*\})*\}")


def c_blocks(source: str, has_texts: bool) -> list[Block]:
    """Return comments, and texts if *has_texts*, of JavaScript, C# or CSS."""
    comment: list[tuple[int, str]] = []
    trailing: list[Block] = []
    strings: list[Block] = []
    for token in _TOKEN_OF_C.finditer(source):
        line = source.count("\n", 0, token.start()) + 1
        begins_line = not source[source.rfind("\n", 0, token.start()) + 1 : token.start()].strip()
        if token["line"]:
            text = token[0].lstrip("/").strip()
            if _DIRECTIVE.match(text):
                continue
            if begins_line:
                comment.append((line, plain(text)))
            else:
                trailing.append(Block(line, "prose", plain(text)))
        elif token["block"]:
            parts = (part.strip().lstrip("*").strip() for part in token[0][2:-2].split("\n"))
            trailing.extend(_paragraphs(enumerate(parts, line)))
        elif has_texts and (text := token["string"] or token["verbatim"]):
            text = _HOLE.sub("X", text.strip("$@").strip("\"'`")).replace("\\n", "\n")
            strings.extend(_strings(line, text))
    return sorted([*_paragraphs(comment), *trailing, *strings])


class _Html(HTMLParser):
    INLINE = frozenset({"a", "b", "code", "em", "i", "kbd", "span", "strong"})
    SHOWN = frozenset({"title", "placeholder", "aria-label", "alt"})

    def __init__(self) -> None:
        super().__init__()
        self.blocks: list[Block] = []
        self._line, self._text, self._skipped = 1, "", False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag in self.INLINE:
            self._text += " X " if tag in ("code", "kbd") else ""
        else:
            self.finish()
            self._skipped = tag in ("script", "style")
        for name, value in attrs:
            if name in self.SHOWN and value:
                self.blocks.extend(_strings(self.getpos()[0], value))

    def handle_endtag(self, tag: str) -> None:
        if tag not in self.INLINE:
            self.finish()
            self._skipped = False

    def handle_data(self, data: str) -> None:
        if not self._skipped:
            self._line = self._line if self._text.strip() else self.getpos()[0]
            self._text += data

    def finish(self) -> None:
        if text := " ".join(self._text.split()):
            self.blocks.append(Block(self._line, "string", plain(text)))
        self._text = ""


def html_blocks(source: str) -> list[Block]:
    """Return the texts of a page."""
    page = _Html()
    page.feed(source)
    page.finish()
    return page.blocks


def script_blocks(source: str) -> list[Block]:
    """Return the comments of a script, and the help texts of a Makefile."""
    lines = []
    helps = []
    for number, line in enumerate(source.splitlines(), 1):
        if line.lstrip().startswith("#"):
            text = line.lstrip().lstrip("#").strip()
            lines.append((number, "" if _DIRECTIVE.match(text) else text))
        elif re.match(r"^[\w-]+:.*## ", line):
            helps.append(Block(number, "string", plain(line.split("## ", 1)[1])))
    return sorted([*_paragraphs(lines), *helps])
