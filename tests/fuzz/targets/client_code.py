# SPDX-License-Identifier: Apache-2.0
"""Clients' code of any definition: its words, which may be a stranger's, never become code."""

import ast
import re
from collections.abc import Callable
from dataclasses import replace

from schemas.definition import Constant, Definition, DefinitionError, Field
from schemas.definition_text import parse_definition
from schemas.generate import csharp_clients, python_clients, typescript_clients
from schemas.generate.catalogue import Catalogue
from schemas.generate.request import MARK, GenerateRequest
from tests.fuzz.choices import Choices
from tests.fuzz.target import Target, check
from tests.schemas.generate.client_code import TEXTS

NAME = "a_msgs/msg/A"
TYPE = re.compile(r"[a-z][a-z0-9_]*/msg/[A-Z][A-Za-z0-9]*", re.ASCII)
WORDS = (
    *("int8 ", "uint8[] ", "string ", "wstring ", "float64 ", "bool[2] ", "string[] ", "B "),
    *("C[] ", "string<=9 ", "a_msgs/B ", "b_msgs/B ", "x", "y", "Z", "from", "class", "default"),
    *("A", "=", "1", " 1", " true", " nan", '="a"', ' "a"', " 'b'", ' ["a", "b"]', "\n", "\n\n"),
    *("\r", "\x85", "\u2028", "#", "# ", "*/", "/*", "//", "///", '"""', "'''", '"', "'", "\\"),
    *("\\n", "${x}", "`", "{", "}", "</summary>", "]]>", ";", "import os", "\x00", "\x1b"),
    *("\U000e0001", "ü", "\t", "  # "),
)
# Next to what is a comment or a text, line ends are those of each language.
CSHARP = re.compile(r'//[^\n\r\x85\u2028\u2029]*|"(?:[^"\\\n\r\x85\u2028\u2029]|\\.)*"')
TYPESCRIPT = re.compile(r'/\*[\s\S]*?\*/|//[^\n\r\u2028\u2029]*|"(?:[^"\\\n\r]|\\.)*"')


def run(data: bytes) -> None:
    choices = Choices(data)
    if choices.happens(128):
        text = ""
        while not choices.is_over:
            text += choices.pick(WORDS)
    else:
        text = choices.rest().decode("utf-8", "replace")
    try:
        definition = parse_definition(NAME, text)
    except DefinitionError:
        return
    if not all(map(TYPE.fullmatch, definition.nested())) or NAME in definition.nested():
        return  # there can be no such type
    for write, skeleton in LANGUAGES:
        check(
            skeleton(write(request_of(definition)))
            == skeleton(write(request_of(mute(definition)))),
            "words have become code",
            write.__module__,
            write(request_of(definition)),
        )


def request_of(definition: Definition) -> GenerateRequest:
    nested = {name: Definition(name, ()) for name in definition.nested()}
    definitions = {**nested, NAME: definition}
    hashes = dict.fromkeys(definitions, "")
    catalogue = Catalogue((), (), definitions, {}, hashes)
    return GenerateRequest((NAME,), catalogue, f"{MARK}a; do not edit.", complete=True)


def mute(definition: Definition) -> Definition:
    """Return the definition with other words and texts."""
    return replace(
        definition,
        comment=other(definition.comment),
        fields=tuple(mute_field(field) for field in definition.fields),
        constants=tuple(mute_constant(constant) for constant in definition.constants),
    )


def mute_field(field: Field) -> Field:
    default = field.default
    if isinstance(default, str):
        default = other(default)
    if isinstance(default, tuple):
        default = tuple(other(each) if isinstance(each, str) else each for each in default)
    return replace(field, comment=other(field.comment), default=default)


def mute_constant(constant: Constant) -> Constant:
    value = other(constant.value) if isinstance(constant.value, str) else constant.value
    return replace(constant, comment=other(constant.comment), value=value)


def other(words: str) -> str:
    """Return other words, or none if there is nothing to be seen of these."""
    return "other" if any(c.isprintable() or c in "\t\n" for c in words) else ""


def python_skeleton(text: str) -> str:
    tree = ast.parse(text)
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            node.value = ""
    return ast.dump(tree)


def csharp_skeleton(text: str) -> list[str]:
    return CSHARP.sub(_texts_alone, text).split()


def typescript_skeleton(text: str) -> list[str]:
    return TYPESCRIPT.sub(_texts_alone, text).split()


def _texts_alone(match: re.Match[str]) -> str:
    return '""' if match[0].startswith('"') else ""


Skeleton = Callable[[str], object]
LANGUAGES: tuple[tuple[Callable[[GenerateRequest], str], Skeleton], ...] = (
    (python_clients.text, python_skeleton),
    (csharp_clients.text, csharp_skeleton),
    (typescript_clients.text, typescript_skeleton),
)


def corpus() -> list[bytes]:
    words = ("# ", "*/", "\n\n", "int8 ", "x")
    plain = [b"\x00" + text.encode() for name, text in TEXTS.items() if "/msg/" in name]
    return [*plain, b"\xff" + bytes(WORDS.index(each) for each in words)]


TARGET = Target("words of a definition never become code", run, corpus)
