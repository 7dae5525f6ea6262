# SPDX-License-Identifier: Apache-2.0
"""IDL of a package: read as a definition that is safe to make code of, or refused with a place."""

import re

from schemas.definition import Definition, DefinitionError
from schemas.definition_text import parse_definition
from schemas.generate.python_models import class_names, class_source
from schemas.idl import parse_idl_interface, parse_idl_message
from tests.fuzz.choices import Choices
from tests.fuzz.target import Target, check
from tests.interfaces import FOLDER

PLACE = re.compile(r"a_msgs/(msg/A|srv/A)\.idl, line [1-9]\d*, column [1-9]\d*: .", re.DOTALL)
NAME = re.compile(r"[A-Za-z]\w*", re.ASCII)
WORDS = (
    *("module a_msgs {", "module msg {", "module srv {", "};", "}", "{", ";", ",", "struct A {"),
    *("struct A_Request {", "struct A_Response {", "module A_Constants {", "const", "typedef", "="),
    *(
        "long",
        "unsigned",
        "short",
        "double",
        "boolean",
        "octet",
        "char",
        "wchar",
        "string",
        "wstring",
    ),
    *("sequence", "<", ">", "[", "]", "(", ")", "::", "a_msgs::msg::B", "x", "y", "T", "A", "from"),
    *(
        "@default",
        "(value=",
        "@verbatim(language=",
        '"comment"',
        "text=",
        "@unit",
        "@key",
        "@a(",
        "#",
    ),
    *("0", "1", "3", "255", "-", "0x7f", "1.5e3", "TRUE", "FALSE", '"', '"a"', 'L"\\u2122"', "'"),
    *(
        '"(1, 2, 3)"',
        "\"('a', 'b')\"",
        '#include "a"',
        "//",
        "/*",
        "*/",
        "\n",
        "\\",
        "enum",
        "union",
    ),
)


def run(data: bytes) -> None:
    choices = Choices(data)
    is_service = choices.happens(64)
    if choices.happens(128):
        text = "module a_msgs { module " + ("srv {" if is_service else "msg {")
        while not choices.is_over:
            text += f" {choices.pick(WORDS)}"
        text += " }; };"
    else:
        text = choices.rest().decode("utf-8", "replace")
    try:
        if is_service:
            found = list(parse_idl_interface("a_msgs/srv/A", text).parts.values())
        else:
            found = [parse_idl_message("a_msgs/msg/A", text)]
    except DefinitionError as error:
        check(PLACE.match(str(error)), "refused without a place", str(error))
        check(len(str(error)) < 1000, "a long refusal", str(error)[:2000])
        return
    for definition in found:
        check_definition(definition)


def check_definition(definition: Definition) -> None:
    names = [each.name for each in (*definition.fields, *definition.constants)]
    names += [part for nested in definition.nested() for part in nested.split("/")]
    check(all(map(NAME.fullmatch, names)), names)
    # code is made of it, and run
    compile(class_source(definition, "", class_names([definition])), "model", "exec")
    again = parse_definition(definition.name, definition.text)
    for one, other in zip(definition.fields, again.fields, strict=True):
        check((one.name, one.type) == (other.name, other.type), one, other)
    for constant, same in zip(definition.constants, again.constants, strict=True):
        check((constant.name, constant.type) == (same.name, same.type), constant, same)


def corpus() -> list[bytes]:
    texts = [path.read_text(encoding="utf-8") for path in sorted(FOLDER.glob("idl_msgs/*/*.idl"))]
    name = re.compile(r"idl_msgs|\b(?:Track|Box|Nothing|Measure|Sweep)(?=\b|_)")
    return [
        b"\x00\x00" + name.sub(lambda m: "a_msgs" if "_" in m[0] else "A", text).encode()
        for text in texts
        if "_Goal" not in text and "_Request" not in text
    ] + [
        b"\xff\x00module a_msgs { module srv { struct A_Request { long x; }; %b }; };"
        % b"struct A_Response { @default(value=-1) long y; };",
        b"\x00\xff" + bytes([WORDS.index(each) for each in ("struct A {", "long", "x", ";", "};")]),
    ]


TARGET = Target("IDL is read as a definition to make code of, or refused with a place", run, corpus)
